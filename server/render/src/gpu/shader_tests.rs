//! Tests of the shaders without a device: they are valid, and what they declare agrees with the host.

use super::bindings::{Binding, bindings};
use crate::{
    plan::{FUNCTIONS_PER_TABLE_TEXEL, LANES, Pass, TRANSFORM_LANES, WORKGROUP},
    shaders::{self, LIBRARY},
    twin::{
        self,
        types::{Column, Frame, Node, Request},
    },
};
use naga::{AddressSpace, ImageClass, StorageAccess, TypeInner};
use std::{collections::BTreeSet, mem::offset_of};

fn parsed(pass: Pass) -> naga::Module {
    let text = shaders::module_text(pass);
    naga::front::wgsl::parse_str(&text)
        .unwrap_or_else(|error| panic!("{}: {}", pass.name(), error.emit_to_string(&text)))
}

#[test]
fn every_pass_validates_without_a_device() {
    for pass in Pass::ALL {
        let mut validator = naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            // unpack2x16float, which every Vulkan device has.
            naga::valid::Capabilities::default() | naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32,
        );
        if let Err(error) = validator.validate(&parsed(pass)) {
            panic!("{}: {}", pass.name(), error.emit_to_string(&shaders::module_text(pass)));
        }
    }
}

#[test]
fn a_broken_shader_does_not_pass_for_valid() {
    let text =
        shaders::module_text(Pass::Blend).replace("blend_radiance(samples", "no_such_function(samples");
    assert!(naga::front::wgsl::parse_str(&text).is_err());
}

/// Every WGSL file is listed and no library file binds anything.
#[test]
fn every_wgsl_file_is_listed() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders");
    let names = |sub: &str| -> BTreeSet<String> {
        let files = std::fs::read_dir(folder.join(sub)).unwrap();
        files.map(|file| file.unwrap().file_name().to_string_lossy().replace(".wgsl", "")).collect()
    };
    assert_eq!(names("lib"), LIBRARY.iter().map(|file| file.name.to_owned()).collect());
    // What a bench holds them against, which is no pass.
    assert_eq!(names("bench"), ["multiply", "stream"].map(str::to_owned).into());
    assert_eq!(names("passes"), Pass::ALL.iter().map(|pass| pass.name().to_owned()).collect());
    for file in LIBRARY {
        assert!(!file.text.contains("@group"), "{}", file.name);
        assert!(!file.text.contains("@compute"), "{}", file.name);
    }
}

/// Each pass has a file of its name among those of the CPU executor, each library file a twin, and each twin a library file.
#[test]
fn passes_and_twins_are_named_like_wgsl() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let names = |sub: &str| -> BTreeSet<String> {
        let files = std::fs::read_dir(folder.join(sub)).unwrap();
        files.map(|file| file.unwrap().file_name().to_string_lossy().replace(".rs", "")).collect()
    };
    let passes: BTreeSet<String> = Pass::ALL.iter().map(|pass| pass.name().to_owned()).collect();
    let others = ["kept_shapes", "lanes", "layout", "mod", "scratch", "work"].map(str::to_owned).into();
    assert_eq!(names("cpu"), &passes | &others);
    let twins = LIBRARY.iter().map(|file| file.name.to_owned()).chain(["mod".to_owned()]);
    assert_eq!(names("twin"), twins.collect());
}

#[test]
fn passes_bind_what_the_host_binds() {
    for pass in Pass::ALL {
        let module = parsed(pass);
        let mut declared: Vec<_> = module
            .global_variables
            .iter()
            .filter_map(|(_, variable)| Some((variable.binding.as_ref()?.binding, variable)))
            .collect();
        declared.sort_by_key(|(number, _)| *number);
        assert_eq!(declared.len(), bindings(pass).len(), "{}", pass.name());
        for ((number, variable), (position, binding)) in
            declared.into_iter().zip(bindings(pass).iter().enumerate())
        {
            assert_eq!(number as usize, position);
            assert_eq!(variable.name.as_deref(), Some(binding.name()), "{}", pass.name());
            let writes = match (&variable.space, &module.types[variable.ty].inner) {
                (AddressSpace::Storage { access }, _) => access.contains(StorageAccess::STORE),
                (_, TypeInner::Image { class: ImageClass::Storage { access, .. }, .. }) => {
                    access.contains(StorageAccess::STORE)
                }
                _ => false,
            };
            assert_eq!(writes, host_writes(*binding), "{} {}", pass.name(), binding.name());
        }
    }
}

fn host_writes(binding: Binding) -> bool {
    match binding.kind() {
        wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Storage { read_only }, .. } => !read_only,
        wgpu::BindingType::StorageTexture { access, .. } => access == wgpu::StorageTextureAccess::WriteOnly,
        _ => false,
    }
}

#[test]
fn passes_keep_within_what_every_device_offers() {
    let limits = wgpu::Limits::downlevel_defaults();
    let excess = |buffers: usize, textures: usize, workgroup_bytes: u32| {
        buffers > limits.max_storage_buffers_per_shader_stage as usize
            || textures > limits.max_storage_textures_per_shader_stage as usize
            || workgroup_bytes > limits.max_compute_workgroup_storage_size
    };
    for pass in Pass::ALL {
        let module = parsed(pass);
        let count = |is_meant: fn(wgpu::BindingType) -> bool| {
            bindings(pass).iter().filter(|binding| is_meant(binding.kind())).count()
        };
        let buffers = count(|kind| {
            matches!(kind, wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Storage { .. }, .. })
        });
        let textures = count(|kind| matches!(kind, wgpu::BindingType::StorageTexture { .. }));
        let shared = module.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::WorkGroup);
        let bytes = shared.map(|(_, v)| module.types[v.ty].inner.size(module.to_ctx())).sum();
        assert!(!excess(buffers, textures, bytes), "{}: {buffers}, {textures}, {bytes}", pass.name());
    }
    assert!(excess(5, 0, 0) && excess(0, 5, 0) && excess(0, 0, 16_385));
}

/// Workgroups are as large as the plan takes them to be.
#[test]
fn workgroups_are_as_large_as_planned() {
    for pass in Pass::ALL {
        let size = parsed(pass).entry_points[0].workgroup_size;
        let expected = match pass {
            Pass::BasisSum => [LANES, 1, 1],
            Pass::AzimuthFft | Pass::InverseFft => [TRANSFORM_LANES, 1, 1],
            _ => [WORKGROUP, 1, 1],
        };
        assert_eq!(size.map(|side| side as usize), expected, "{}", pass.name());
    }
    assert_eq!(FUNCTIONS_PER_TABLE_TEXEL, 8);
}

macro_rules! assert_layout {
    ($module:expr, $name:literal, $host:ty, [$($field:ident),*]) => {{
        let module = $module;
        let (_, found) = module.types.iter().find(|(_, found)| found.name.as_deref() == Some($name)).unwrap();
        let TypeInner::Struct { members, span } = &found.inner else { panic!("{} is no struct", $name) };
        assert_eq!(*span as usize, size_of::<$host>(), $name);
        let declared: Vec<_> =
            members.iter().map(|member| (member.name.clone().unwrap(), member.offset as usize)).collect();
        let host = vec![$((stringify!($field).to_owned(), offset_of!($host, $field))),*];
        assert_eq!(declared, host, $name);
    }};
}

#[test]
fn structures_lie_alike_on_both_sides() {
    let module = naga::front::wgsl::parse_str(shaders::TYPES.text).unwrap();
    assert_layout!(
        &module,
        "Frame",
        Frame,
        [
            request_count,
            node_count,
            cell_count,
            basis_count,
            quad_count,
            table_octet_count,
            ring_count,
            offset_count,
            pack_slot,
            pack_count,
            blocked_octet_count,
            blocked_offset_count,
            kink_node,
            blocked_kink_node
        ]
    );
    assert_layout!(
        &module,
        "Request",
        Request,
        [
            altitude_index,
            altitude_weight,
            blend_weight,
            linear_weight,
            emission,
            altitude_count,
            flux_per_dnb_flux,
            blocked_altitude_index,
            blocked_altitude_weight,
            blocked_altitude_count
        ]
    );
    assert_layout!(&module, "Node", Node, [request, ring, offset, blocking]);
    assert_layout!(&module, "Column", Column, [request, azimuth, first_cell, end_cell]);
}

#[test]
fn constants_are_the_same_on_both_sides() {
    let constant = |file: shaders::LibraryFile, name: &str| -> f64 {
        let start = file.text.find(&format!("const {name}:")).unwrap_or_else(|| panic!("{name} is missing"));
        let line = file.text[start..].lines().next().unwrap();
        line.split('=').nth(1).unwrap().trim().trim_end_matches(';').trim_end_matches('u').parse().unwrap()
    };
    for (name, value) in [
        ("BAND_COUNT", skyglow_physics::BAND_COUNT),
        ("MAX_BAND_COUNT", twin::MAX_BAND_COUNT),
        ("LOBE_COUNT", skyglow_physics::LOBE_COUNT),
        ("AZIMUTH_COUNT", skyglow_physics::AZIMUTH_COUNT),
        ("ELEVATION_COUNT", skyglow_physics::ELEVATION_COUNT),
        ("MAX_BATCH", crate::MAX_BATCH),
        ("FREQUENCY_COUNT", skyglow_tables::resident::FREQUENCY_COUNT),
    ] {
        assert_eq!(constant(shaders::TYPES, name), value as f64, "{name}");
    }
    for (name, value) in [
        ("CELLS_PER_ROW", twin::indexing::CELLS_PER_ROW),
        ("NODE_ROWS", twin::indexing::NODE_ROWS),
        ("BLOCKED_ANGLE_COUNT", skyglow_physics::blocking::BLOCKING_COUNT as u32 - 1),
    ] {
        assert_eq!(constant(shaders::INDEXING, name), f64::from(value), "{name}");
    }
    let floor = constant(shaders::BLENDING, "RADIANCE_FLOOR_W_M2_SR");
    assert_eq!(floor as f32, twin::RADIANCE_FLOOR_W_M2_SR);
    assert_eq!(constant(shaders::BLENDING, "MAX_DEVIATION") as f32, twin::MAX_DEVIATION);
    assert_eq!(constant(shaders::BLENDING, "MAX_DEVIATION_SHARE") as f32, twin::MAX_DEVIATION_SHARE);
    assert_eq!(constant(shaders::BLENDING, "MIN_PACK_RATIO") as f32, twin::MIN_PACK_RATIO);
}
