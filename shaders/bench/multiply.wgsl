// Chains of multiply-adds that stay in registers: x goes to addend ÷ (1 − factor), whatever it was.

/// Factor, addend, and where the chains start; the number of rounds.
struct Chain {
    factor: f32,
    addend: f32,
    start: f32,
    rounds: u32,
}

@group(0) @binding(0) var<storage, read> chain: Chain;
@group(0) @binding(1) var<storage, read_write> results: array<vec4<f32>>;

@compute @workgroup_size(256)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let factor = vec4<f32>(chain.factor);
    let addend = vec4<f32>(chain.addend);
    let first = vec4<f32>(chain.start) + vec4<f32>(f32(id.x & 7u));
    var a = first;
    var b = first + 1.0;
    var c = first + 2.0;
    var d = first + 3.0;
    for (var round = 0u; round < chain.rounds; round++) {
        a = fma(a, factor, addend);
        b = fma(b, factor, addend);
        c = fma(c, factor, addend);
        d = fma(d, factor, addend);
    }
    results[id.x] = 0.25 * (a + b + c + d);
}
