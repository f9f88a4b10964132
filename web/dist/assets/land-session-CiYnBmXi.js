import{o as e,t}from"./client-D1QyJSWC.js";import{d as n}from"./scale-Dxgj8Xx_.js";import{i as r}from"./shading-DSptAfDO.js";import{a as i,h as a,l as o,w as s,x as c}from"./units-BYejPf2A.js";import{n as l}from"./dom-B4Lvlc-b.js";import{t as u}from"./picture-url-C0_Bik8_.js";var d=[0,90,180,270],f=[1024,1536],p=.75,m=1/Math.tan(35*Math.PI/180),h=.9;function g([e,t,n]){let r=Math.abs(e)>Math.abs(t),i=Math.max(Math.abs(e),Math.abs(t)),a=r?-t*Math.sign(e):e*Math.sign(t||1);return{face:r?e>0?1:3:t<0?2:0,across:.5+.5*a/i,down:.5-.5*n/i}}function _(){return d.map(e=>({azimuthDeg:e,elevationDeg:0,fieldDeg:90}))}function v(e,t){let n=h*m*p*Math.min(e,t);return f.find(e=>e>=n)??f[f.length-1]??1024}var y=class{faces;fragmentShader;pixels=null;constructor(e,t){this.faces=e,this.fragmentShader=t}rgbAt(e){this.pixels??=this.faces.map(b);let{face:t,across:r,down:i}=g(n(e)),a=this.faces[t]?.width??1,o=e=>Math.min(Math.max(Math.floor(e*a),0),a-1),s=4*(o(i)*a+o(r));return this.pixels[t]?.subarray(s,s+3)??new Uint8ClampedArray(3)}close(){for(let e of this.faces)e.close()}};function b(e){let t=new OffscreenCanvas(e.width,e.height).getContext(`2d`);return t?.drawImage(e,0,0),t?.getImageData(0,0,e.width,e.height).data??new Uint8ClampedArray}var x=`// The land in light, from four pictures of it, before the sky. The twin of land-faces.ts.

/** Towards north, east, south and west, a quarter turn wide and high. */
uniform sampler2DArray faces;
/** The lower left corner of the plot on the canvas. */
uniform vec2 origin_px;
in vec3 interpolated;
out vec4 colour;

/** Between the columns of the grid the skyline is a straight line, and ridges of the pictures rise above it: they have so much of the sky
 * above the line with them, whose colours are the same, and fade into it. */
const float COVERED_DEG = 0.35;
const float FADING_DEG = 0.15;

/** In (east, north, up), of any length. */
vec3 ray_at(vec2 at_px) {
  return projection == PERSPECTIVE ? camera * vec3(at_px - 0.5 * plot_px, focal_px) : vector_of(direction_at(at_px));
}

void main() {
  float part = clamp((COVERED_DEG + FADING_DEG - interpolated.r) / FADING_DEG, 0.0, 1.0);
  if (part == 0.0) discard;
  vec3 ray = ray_at(gl_FragCoord.xy - origin_px);
  bool across = abs(ray.x) > abs(ray.y);
  float ahead = max(abs(ray.x), abs(ray.y));
  float right = across ? -ray.y * sign(ray.x) : ray.x * (ray.y < 0.0 ? -1.0 : 1.0);
  float face = across ? (ray.x > 0.0 ? 1.0 : 3.0) : (ray.y < 0.0 ? 2.0 : 0.0);
  // Where a picture ends, what is near goes on below it: it differs by azimuth alone.
  vec2 at = 0.5 + 0.5 * vec2(right, -ray.z) / ahead;
  float texels = 0.5 * float(textureSize(faces, 0).x) * pixel_rad();
  colour = vec4(encoded(textureLod(faces, vec3(at, face), log2(texels)).rgb) * part, part);
}
`,S=80,C=1e-4,w=4,T={dark:0,lit:.15,snow:.75},E=1e-5,D=class{store;controller=new AbortController;requested=``;constructor(e){this.store=e;let t=l(S,()=>void this.load()),n=[a,`panorama`,`panoramaToday`,`sky`,`exposureEv`,`adaptationCdM2`,`colours`];e.watch([...n,c,`place`,`time`,`isBusy`,`isAway`,...i],e=>{a(e)===`dark`||e.panorama===null?this.forget():t()})}async load(){let{state:t}=this.store;if(a(t)===`dark`||t.isBusy||t.isAway)return;let n=k(t),r=A({...t,landCdM2:n}),i=JSON.stringify(r);if(r===null||i===this.requested)return;this.controller.abort(),this.controller=new AbortController;let{signal:o}=this.controller;this.requested=i,this.store.set({isLandBusy:!0,landCdM2:n});try{let e=r.today===null?[r.shown]:[r.shown,r.today],[t=null,n=null]=await Promise.all(e.map(e=>O(e,o)));if(o.aborted)return;this.show(t,n)}catch(t){if(o.aborted)return;this.show(null,null),e(t)&&(this.requested=``),this.store.report(t)}}forget(){this.controller.abort(),this.requested=``;let{landscape:e,isLandBusy:t}=this.store.state;(e!==null||t)&&this.show(null,null),this.store.state.landCdM2!==null&&this.store.set({landCdM2:null})}show(e,t){let n=this.store.state;this.store.set({landscape:e,landscapeToday:t,isLandBusy:!1}),n.landscape?.close(),n.landscapeToday?.close()}};async function O(e,n){let r=e.map(async e=>createImageBitmap(await t.picture(e,n),{premultiplyAlpha:`none`,colorSpaceConversion:`none`}));return new y(await Promise.all(r),x)}function k(e){let{answer:t,site:n}=e;if(t===null)return null;let r=e.sky===`total`?t.sky.horizontal_total_illuminance_lx:t.sky.horizontal_illuminance_lx;return T[a(e)]*r/Math.PI+(n?.radiance_nw_cm2_sr??0)*E*t.lamp.lumens_per_dnb_watt}function A(e){let{place:t,panorama:n,panoramaToday:i}=e,a=c(e);if(a===null||t===null||n===null)return null;let l=v(innerWidth*devicePixelRatio,innerHeight*devicePixelRatio),d=Math.max(+r(n,e).toPrecision(w),C),f={width:l,height_px:l,legend:`off`,...e.colours===`eye`?{adaptation:d}:{}},p=t=>_().map(n=>u(a.id,t,{...e,projection:`perspective`,gaze:n,skyAspect:1},f,`webp`)),m={...o(t),...s(e)},{scenario:h,...g}=m;return{shown:p(m),today:i===null?null:p(g)}}export{D as LandSession};