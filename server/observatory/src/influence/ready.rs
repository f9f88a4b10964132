//! What maps of one place under one air have in common: a measure or a curve changes, the light and its sky do not.

use super::blended_sky::blended;
use crate::error::ObservatoryError;
use moka::sync::Cache;
use skyglow_physics::{BAND_COUNT, LOBE_COUNT, Panorama};
use skyglow_render::{
    cpu::{
        CpuExecutor,
        layout::{MixedNode, NodeScales},
        mix_scale::mix_scale,
        mix_shape::mix_shape,
    },
    near_field::{NearFieldCorrection, VisibleLights},
    pack_kind::PackKind,
    prepare::Prepared,
    request::RenderRequest,
    table_set::TableSet,
};
use std::{sync::Arc, time::Duration};

/// How long what nobody asks for is kept.
const KEPT_WHILE_IDLE: Duration = Duration::from_secs(600);

/// Scales and shapes of a request's nodes in one pack.
pub(super) struct NodesOfPack {
    pub(super) scales: Vec<NodeScales>,
    pub(super) mixed: Vec<MixedNode>,
}

/// A sky that cells are a part of.
pub(super) struct KnownSky {
    /// In every pack of the turbidity's stencil, `[band][row][column]`, W m⁻² sr⁻¹.
    pub(super) of_packs: Vec<Vec<f32>>,
    /// Between them, as cells make it; None where there is no light at all.
    pub(super) between: Option<Panorama>,
    /// The same with near lights as they are; None where there are none.
    whole: Option<Panorama>,
    /// The near lights and which of them show in it; None where there are none.
    pub(super) near: Option<(NearFieldCorrection, VisibleLights)>,
}

impl KnownSky {
    /// The sky with near lights as they are.
    pub(super) fn whole(&self) -> Option<&Panorama> {
        self.whole.as_ref().or(self.between.as_ref())
    }
}

/// A request made ready, with what its measures are found from.
pub(super) struct ReadyRequest {
    pub(super) prepared: Prepared,
    /// In every pack of the turbidity's stencil.
    pub(super) nodes: Vec<NodesOfPack>,
    /// None where no sky was asked for.
    pub(super) sky: Option<KnownSky>,
    /// Held so that no other light comes to lie at the address that the key has of it.
    _requests: [Option<RenderRequest>; 2],
    bytes: usize,
}

/// Everything that decides what a request makes of the tables: the light by its address, numbers by their bits.
type RequestKey = (usize, PackKind, [u64; 2 + LOBE_COUNT + BAND_COUNT], Option<usize>);

/// The requests made ready last.
pub(super) struct ReadyRequests(Cache<(RequestKey, Option<RequestKey>), Arc<ReadyRequest>>);

impl ReadyRequests {
    /// * `most_bytes`: of all together.
    pub(super) fn new(most_bytes: u64) -> Self {
        let weigh = |_: &_, ready: &Arc<ReadyRequest>| u32::try_from(ready.bytes).unwrap_or(u32::MAX);
        Self(Cache::builder().max_capacity(most_bytes).weigher(weigh).time_to_idle(KEPT_WHILE_IDLE).build())
    }

    /// A request, and the sky that it is seen in if one is asked for: made ready, or as it was before.
    pub(super) fn get(
        &self,
        request: &RenderRequest,
        sky: Option<&RenderRequest>,
        set: &TableSet,
        executor: &CpuExecutor,
    ) -> Result<Arc<ReadyRequest>, ObservatoryError> {
        let key = (key_of(request), sky.map(key_of));
        if let Some(ready) = self.0.get(&key) {
            return Ok(ready);
        }
        let ready = Arc::new(ReadyRequest::new(request, sky, set, executor)?);
        self.0.insert(key, Arc::clone(&ready));
        Ok(ready)
    }
}

fn key_of(request: &RenderRequest) -> RequestKey {
    let mut numbers = [0; 2 + LOBE_COUNT + BAND_COUNT];
    let values = [request.observer_altitude_m, request.turbidity.value()];
    let values = values.into_iter().chain(request.emission.weights()).chain(request.flux_per_dnb_flux);
    numbers.iter_mut().zip(values).for_each(|(number, value)| *number = value.to_bits());
    (Arc::as_ptr(&request.polar) as usize, request.kind(), numbers, request.basis)
}

impl ReadyRequest {
    fn new(
        request: &RenderRequest,
        sky: Option<&RenderRequest>,
        set: &TableSet,
        executor: &CpuExecutor,
    ) -> Result<Self, ObservatoryError> {
        // A request in its own sky needs no other.
        let other = sky.filter(|sky| !std::ptr::eq(request, *sky));
        let (prepared, of_sky) = rayon::join(
            || Prepared::new(request, set),
            || other.map(|sky| Prepared::new(sky, set)).transpose(),
        );
        let (prepared, of_sky) = (prepared?, of_sky?);
        let packs = prepared.turbidity_stencil.nodes();
        let nodes_of = |pack: usize| {
            let (tables, mut scales, mut mixed) = (&set.tables()[pack], Vec::new(), Vec::new());
            mix_scale(tables, &prepared, true, &mut scales);
            mix_shape(tables, &prepared, &scales, true, &mut mixed);
            NodesOfPack { scales, mixed }
        };
        let nodes: Vec<NodesOfPack> =
            if prepared.is_dark() { Vec::new() } else { packs.clone().map(nodes_of).collect() };
        let sky_known = sky.filter(|_| !prepared.is_dark()).map(|_| {
            let of_sky = of_sky.as_ref().unwrap_or(&prepared);
            if of_sky.is_dark() {
                return KnownSky {
                    of_packs: vec![vec![0.0; Panorama::LEN]; packs.len()],
                    between: None,
                    whole: None,
                    near: None,
                };
            }
            let of_packs: Vec<Vec<f32>> = packs.map(|pack| executor.sky(of_sky, pack, true)).collect();
            let between = blended(of_packs.clone(), &prepared.turbidity_stencil, true);
            let near = between.as_ref().and_then(|between| {
                let near = of_sky.near.clone()?;
                let visible = near.visible_lights(set, between.samples());
                Some((near, visible))
            });
            let whole = between.as_ref().zip(near.as_ref()).map(|(between, (_, visible))| {
                let mut whole = between.clone();
                visible.add_to(whole.samples_mut());
                whole
            });
            KnownSky { of_packs, between, whole, near }
        });
        let grids = [Some(request), other].map(|held| held.map_or(0, |held| held.polar.byte_count()));
        let of_nodes = |nodes: &NodesOfPack| size_of_val(&*nodes.scales) + size_of_val(&*nodes.mixed);
        let of_sky = sky_known.as_ref().map_or(0, |sky| {
            let of_near = sky.near.as_ref().map_or(0, |(_, visible)| visible.byte_count());
            let skies = 1 + sky.of_packs.len() + usize::from(sky.whole.is_some());
            skies * 4 * Panorama::LEN + of_near
        });
        let bytes = size_of_val(&*prepared.cells)
            + size_of_val(&*prepared.nodes)
            + nodes.iter().map(of_nodes).sum::<usize>()
            + grids.iter().sum::<usize>()
            + of_sky;
        let requests = [Some(request.clone()), other.cloned()];
        Ok(Self { prepared, nodes, sky: sky_known, _requests: requests, bytes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::{EmissionMix, Turbidity};
    use skyglow_render::synthetic;

    /// A request is made ready once and any other by itself.
    #[test]
    fn a_request_is_made_ready_once() {
        let set = TableSet::new(synthetic::table_set(&[1.5, 2.5, 3.5], 8)).unwrap();
        let (executor, kept) = (CpuExecutor::new(set.clone()), ReadyRequests::new(1 << 30));
        let get = |request: &RenderRequest, sky: Option<&RenderRequest>| {
            kept.get(request, sky, &set, &executor).unwrap()
        };
        let request = synthetic::request(synthetic::polar_grid(3, 500), Turbidity::new(2.5).unwrap());
        let first = get(&request, Some(&request));
        assert!(Arc::ptr_eq(&first, &get(&request.clone(), Some(&request.clone()))));
        let others = [
            RenderRequest { polar: Arc::new(request.polar.as_ref().clone()), ..request.clone() },
            RenderRequest { observer_altitude_m: request.observer_altitude_m + 1.0, ..request.clone() },
            RenderRequest { turbidity: Turbidity::new(3.0).unwrap(), ..request.clone() },
            RenderRequest { emission: EmissionMix::lambert(), ..request.clone() },
            RenderRequest { flux_per_dnb_flux: [0.5; BAND_COUNT], ..request.clone() },
            RenderRequest { basis: Some(7), ..request.clone() },
        ];
        for other in &others {
            assert!(!Arc::ptr_eq(&first, &get(other, Some(other))), "{other:?}");
            assert!(!Arc::ptr_eq(&first, &get(&request, Some(other))), "{other:?}");
        }
        let without_sky = get(&request, None);
        assert!(without_sky.sky.is_none() && first.sky.is_some());
        assert!(first.bytes > without_sky.bytes && without_sky.bytes > 0);
    }
}
