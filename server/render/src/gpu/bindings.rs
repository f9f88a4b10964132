//! What each pass binds, by the names that its WGSL gives them, in the order of their numbers.

use crate::plan::Pass;

/// A resource as one pass sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Binding {
    Frame,
    Requests,
    Nodes,
    Cells,
    Columns,
    Twiddles,
    LogScale,
    BlockedLogScale,
    Shape,
    BlockedShape,
    Basis,
    Scales(Access),
    LogScales(Access),
    Mixed(Access),
    Weights(Access),
    Coefficients(Access),
    Spectra(Access),
    Sums(Access),
    Radiance(Access),
    Blended,
}

/// Whether a pass reads or writes a resource that others write or read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Access {
    Read,
    Write,
}

use Access::{Read, Write};

/// Bindings of a pass, numbered from 0.
pub(crate) const fn bindings(pass: Pass) -> &'static [Binding] {
    use Binding as B;
    match pass {
        Pass::MixScale => &[
            B::Frame,
            B::Requests,
            B::Nodes,
            B::LogScale,
            B::BlockedLogScale,
            B::Scales(Write),
            B::LogScales(Write),
        ],
        Pass::MixShape => {
            &[B::Frame, B::Requests, B::Nodes, B::Scales(Read), B::Shape, B::BlockedShape, B::Mixed(Write)]
        }
        Pass::CellWeights => &[B::Frame, B::Requests, B::Cells, B::LogScales(Read), B::Weights(Write)],
        Pass::Coefficients => {
            &[B::Frame, B::Columns, B::Weights(Read), B::Mixed(Read), B::Coefficients(Write)]
        }
        Pass::AzimuthFft => &[B::Frame, B::Twiddles, B::Coefficients(Read), B::Spectra(Write)],
        Pass::BasisSum => &[B::Frame, B::Spectra(Read), B::Basis, B::Sums(Write)],
        Pass::InverseFft => &[B::Frame, B::Twiddles, B::Sums(Read), B::Radiance(Write)],
        Pass::Blend => &[B::Frame, B::Requests, B::Radiance(Read), B::Blended],
    }
}

impl Binding {
    /// The name in WGSL.
    #[cfg(test)]
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Binding::Frame => "frame",
            Binding::Requests => "requests",
            Binding::Nodes => "nodes",
            Binding::Cells => "cells",
            Binding::Columns => "columns",
            Binding::Twiddles => "twiddles",
            Binding::LogScale => "log_scale",
            Binding::BlockedLogScale => "blocked_log_scale",
            Binding::Shape => "shape",
            Binding::BlockedShape => "blocked_shape",
            Binding::Basis => "basis",
            Binding::Scales(_) => "scales",
            Binding::LogScales(_) => "log_scales",
            Binding::Mixed(_) => "mixed",
            Binding::Weights(_) => "weights",
            Binding::Coefficients(_) => "coefficients",
            Binding::Spectra(_) => "spectra",
            Binding::Sums(_) => "sums",
            Binding::Radiance(_) => "radiance",
            Binding::Blended => "blended",
        }
    }

    /// What the layout says of it.
    pub(crate) const fn kind(self) -> wgpu::BindingType {
        const fn buffer(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
            wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
        }
        const fn storage(access: Access) -> wgpu::BindingType {
            buffer(wgpu::BufferBindingType::Storage { read_only: matches!(access, Read) })
        }
        // Textures are read as storage too: software Vulkan takes half the time for it that it takes for a sampled
        // texture's texel.
        const fn texture(
            access: wgpu::StorageTextureAccess,
            format: wgpu::TextureFormat,
            view_dimension: wgpu::TextureViewDimension,
        ) -> wgpu::BindingType {
            wgpu::BindingType::StorageTexture { access, format, view_dimension }
        }
        use wgpu::{
            StorageTextureAccess::{ReadOnly, WriteOnly},
            TextureFormat::{Rgba32Float, Rgba32Uint},
            TextureViewDimension::{D2, D2Array},
        };
        match self {
            Binding::Frame | Binding::Requests => buffer(wgpu::BufferBindingType::Uniform),
            Binding::Nodes
            | Binding::Columns
            | Binding::Twiddles
            | Binding::LogScale
            | Binding::BlockedLogScale => storage(Read),
            Binding::Blended => storage(Write),
            Binding::Radiance(access) => storage(access),
            Binding::Shape | Binding::BlockedShape => texture(ReadOnly, Rgba32Uint, D2Array),
            Binding::Cells | Binding::Basis => texture(ReadOnly, Rgba32Float, D2),
            Binding::Scales(access)
            | Binding::LogScales(access)
            | Binding::Mixed(access)
            | Binding::Weights(access)
            | Binding::Coefficients(access)
            | Binding::Spectra(access)
            | Binding::Sums(access) => {
                let access = if matches!(access, Read) { ReadOnly } else { WriteOnly };
                texture(access, Rgba32Float, D2)
            }
        }
    }
}
