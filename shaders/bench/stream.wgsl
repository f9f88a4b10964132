// Copies a buffer, sixteen bytes an invocation, the rows of a two-dimensional dispatch one after another.

@group(0) @binding(0) var<storage, read> read_from: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> write_to: array<vec4<f32>>;

@compute @workgroup_size(256)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let at = id.y * groups.x * 256u + id.x;
    if at < arrayLength(&read_from) {
        write_to[at] = read_from[at];
    }
}
