use skyglow_tables::*; use skyglow_physics::{*,single_source::*,panorama::*}; use rayon::prelude::*; use std::time::Instant;
fn main(){ let a:Vec<String>=std::env::args().collect(); let s=Instant::now(); let pack=Pack::open(std::path::Path::new(&a[1])).unwrap(); println!("open {:.3}",s.elapsed().as_secs_f64()); let at=Atmosphere::new(Turbidity::new(pack.manifest().turbidity).unwrap());
 let mode:usize=a[2].parse().unwrap(); let n=a[3].parse::<usize>().unwrap();
 let m=pack.manifest().basis_count;
 let res:Vec<(usize,usize,f64,f64,f64,f64,f64,f64)>=(1..=n).into_par_iter().flat_map_iter(|i|{ let u=|k:f64|(i as f64*k).fract();
  let (mut r,mut ho)=(250.0*1200f64.powf(u(0.8191725)),6000.0*u(0.6710436).powi(2)); let ax=&pack.manifest().axes;
  if mode&1>0 { let j=(u(0.8191725)*ax.distance_m.len() as f64) as usize; r=ax.distance_m[j]; } if mode&2>0 { let j=(u(0.6710436)*ax.observer_altitude_m.len() as f64) as usize; ho=ax.observer_altitude_m[j]; }
  let hi=(0.3*r).min(6000.0-ho); let mut d= -ho+(ho+hi)*u(0.5497005);
  let tab=pack.resident(&[r]); let oa=tab.offset_axis[0]; if mode&4>0 { d=oa.offset_m(oa.position(d).round() as usize); }
  let g=SourceGeometry{distance_m:r,source_altitude_m:ho+d,observer_altitude_m:ho};
  let taps=lagrange_taps(&tab.observer_altitude_m,ho,4); let p=oa.position(d); let lo=(p as usize).min(tab.offset_count-2); let t=p-lo as f64;
  let z=radiance_per_watt_of(&at,&g,1.5,elevation_rad(63),1e-6); let mut out=vec![];
  for q in 0..24usize { let row=if q<3{63}else{(q*25+i*7)%64}; let col=(q*53+i*31)%129; let tr=radiance_per_watt_of(&at,&g,azimuth_rad(col),elevation_rad(row),1e-6);
   for l in 0..3 { for b in 0..3 { let node=|o,s|tab.node_index(o,l,b,0,lo+s);
    let ls:f64=taps.iter().map(|&(o,w)|w*((1.0-t)*tab.log_scale[node(o,0)] as f64+t*tab.log_scale[node(o,1)] as f64)).sum();
    let v:f64=(0..m).map(|k|{ let c:f64=taps.iter().map(|&(o,w)|w*((1.0-t)*tab.shape[node(o,0)*m+k].to_f64()+t*tab.shape[node(o,1)*m+k].to_f64())).sum();
      // basis at (row,col) from spectrum
      let sp=&tab.basis_spectrum[tab.spectrum_index(k,row,0)..][..129]; let th=azimuth_rad(col); let mut x=sp[0] as f64+sp[128] as f64*(128.0*th).cos(); for f in 1..128 { x+=2.0*sp[f] as f64*(f as f64*th).cos(); } c*x/256.0 }).sum::<f64>()*ls.exp();
    let fl=tr[b][l].max(2e-3*z[b][l]).max(1e-22); out.push((l,if q<3{1}else{0},(v.max(0.0)-tr[b][l]).abs()/fl,r,ho,d,azimuth_rad(col).to_degrees(),row as f64)); }}} out}).collect();
 for l in 0..3 { for zq in 0..2 { let mut e:Vec<_>=res.iter().filter(|x|x.0==l&&x.1==zq).collect(); e.sort_by(|a,b|a.2.total_cmp(&b.2)); let k=e.len(); println!("mode {mode} lobe {l} zenith {zq}: mean {:.4} p50 {:.4} p90 {:.4} p99 {:.4} max {:.2e}",e.iter().map(|x|x.2).sum::<f64>()/k as f64,e[k/2].2,e[k*9/10].2,e[k*99/100].2,e[k-1].2); if a.len()>4 { for x in e.iter().rev().take(12) {println!("   {:?}",x);} } }}
}
