import{s as e,t}from"./client-BU0QH2W9.js";import{d as n}from"./scale-thEbAnjl.js";import{i as r}from"./shading-Dl2d5Qno.js";import{i,m as a,p as o,s,t as c,w as l,x as u}from"./app-state-CH1kh_ln.js";import{n as d}from"./dom-DGJEoGo1.js";import{t as f}from"./picture-url-W_GRwof9.js";var p=[0,90,180,270],m=[1024,1536],h=.75,g=1/Math.tan(35*Math.PI/180),_=.9;function v([e,t,n]){let r=Math.abs(e)>Math.abs(t),i=Math.max(Math.abs(e),Math.abs(t)),a=r?-t*Math.sign(e):e*Math.sign(t||1);return{face:r?e>0?1:3:t<0?2:0,across:.5+.5*a/i,down:.5-.5*n/i}}function y(){return p.map(e=>({azimuthDeg:e,elevationDeg:0,fieldDeg:90}))}function b(e,t){let n=_*g*h*Math.min(e,t);return m.find(e=>e>=n)??m[m.length-1]??1024}var x=class{faces;fragmentShader;pixels=null;constructor(e,t){this.faces=e,this.fragmentShader=t}rgbAt(e){this.pixels??=this.faces.map(S);let{face:t,across:r,down:i}=v(n(e)),a=this.faces[t]?.width??1,o=e=>Math.min(Math.max(Math.floor(e*a),0),a-1),s=4*(o(i)*a+o(r));return this.pixels[t]?.subarray(s,s+3)??new Uint8ClampedArray(3)}close(){for(let e of this.faces)e.close()}};function S(e){let t=new OffscreenCanvas(e.width,e.height).getContext(`2d`);return t?.drawImage(e,0,0),t?.getImageData(0,0,e.width,e.height).data??new Uint8ClampedArray}var C=`// The land in light, from four pictures of it, before the sky. The twin of land-faces.ts.

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
`,w=80,T=1e-4,E=4,D=class{store;controller=new AbortController;requested=``;constructor(e){this.store=e;let t=d(w,()=>void this.load()),n=[a,`panorama`,`panoramaToday`,`sky`,`exposureEv`,`adaptationCdM2`,`colours`];e.watch([...n,u,`place`,`time`,`isBusy`,`isAway`,...c],e=>{a(e)===`dark`||e.panorama===null?this.forget():t()})}async load(){let{state:t}=this.store;if(a(t)===`dark`||t.isBusy||t.isAway)return;let n=k(t),r=JSON.stringify(n);if(n===null||r===this.requested)return;this.controller.abort(),this.controller=new AbortController;let{signal:i}=this.controller;this.requested=r,this.store.set({isLandBusy:!0});try{let e=n.today===null?[n.shown]:[n.shown,n.today],[t=null,r=null]=await Promise.all(e.map(e=>O(e,i)));if(i.aborted)return;this.show(t,r)}catch(t){if(i.aborted)return;this.show(null,null),e(t)&&(this.requested=``),this.store.report(t)}}forget(){this.controller.abort(),this.requested=``;let{landscape:e,isLandBusy:t}=this.store.state;(e!==null||t)&&this.show(null,null)}show(e,t){let n=this.store.state;this.store.set({landscape:e,landscapeToday:t,isLandBusy:!1}),n.landscape?.close(),n.landscapeToday?.close()}};async function O(e,n){let r=e.map(async e=>createImageBitmap(await t.picture(e,n),{premultiplyAlpha:`none`,colorSpaceConversion:`none`}));return new x(await Promise.all(r),C)}function k(e){let{place:t,panorama:n,panoramaToday:a}=e,c=u(e);if(c===null||t===null||n===null)return null;let d=b(innerWidth*devicePixelRatio,innerHeight*devicePixelRatio),p=Math.max(+r(n,e,o(e)).toPrecision(E),T),m={width:d,height_px:d,legend:`off`,...e.colours===`eye`?{adaptation:p}:{}},h=(t,n=c.id)=>y().map(r=>f(n,t,{...e,projection:`perspective`,gaze:r,skyAspect:1},m,`webp`)),g={...s(t),...l(e)},{scenario:_,...v}=g;return{shown:h(g),today:a===null?null:h(v,i(e)?.id)}}export{D as LandSession};