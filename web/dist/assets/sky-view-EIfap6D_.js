import{L as e,p as t,z as n}from"./app-state-CH1kh_ln.js";import{n as r,r as i}from"./dom-DGJEoGo1.js";import{t as a}from"./nearby-DTPTKovA.js";import{a as o,n as s,r as c,t as l}from"./gaze-DxemtyTB.js";import{d as u}from"./photometry-CxtHMIAq.js";import{a as d,c as f,d as p,h as m,l as h,o as g,u as _}from"./scale-thEbAnjl.js";import{a as v,c as y,d as b,f as x,g as S,h as C,i as w,m as T,o as E,p as ee,r as te,s as ne}from"./shading-Dl2d5Qno.js";var re=8,ie={ArrowLeft:[-1,0],ArrowRight:[1,0],ArrowUp:[0,1],ArrowDown:[0,-1]};function ae({key:e,shiftKey:t},n,r){let i=ie[e];if(i===void 0)return null;let a=t?re:1,o=r.nearest(n.azimuthDeg,n.elevationDeg),s=r.elevationFirstDeg+(r.elevationCount-1)*r.elevationStepDeg,c=o.elevationDeg+i[1]*a*r.elevationStepDeg;return{azimuthDeg:(o.azimuthDeg+i[0]*a*r.azimuthStepDeg+360)%360,elevationDeg:Math.min(Math.max(c,r.elevationFirstDeg),s)}}var oe=class{directions=null;get trail(){return this.directions}set(e){this.directions=e?[]:null}restart(){this.directions!==null&&(this.directions=[])}extend(e){e!==null&&this.directions?.push(e)}close(){if(this.directions===null||this.directions.length===0)return null;let e=n(this.directions);return this.directions=[],e}setCorner(e){if(e===null)return null;let t=this.directions?.at(-1);return t?.azimuthDeg===e.azimuthDeg&&t.elevationDeg===e.elevationDeg?this.close():(this.extend(e),null)}};function D(e,t=500){return`${t} ${e}px system-ui, sans-serif`}function O(e,t){e.beginPath(),e.rect(t.leftPx,t.topPx,t.widthPx,t.heightPx),e.clip()}function k(e,t){let n=[],r=null;for(let i of t){let{xPx:t,yPx:a}=e.pointFromDirection(i);if(Number.isNaN(t)){r=null;continue}let o=e.name===`equirectangular`&&r!==null&&Math.abs(i.azimuthDeg-r)>180;(r===null||o)&&n.push([]),n.at(-1)?.push([t,a]),r=i.azimuthDeg}return n}function se(e,t,n){e.beginPath();for(let r of k(t,n))ce(e,r);e.stroke()}function ce(e,t){t.forEach((t,n)=>{n===0?e.moveTo(...t):e.lineTo(...t)})}function A(e,t){e.beginPath(),ce(e,t),e.stroke()}function j(e){return`rgba(${e})`}function M(e,{lines:t,names:n,isClipped:r},i){e.save(),r&&O(e,i);for(let{points:n,ink:r,widthPx:i}of t)e.strokeStyle=j(r),e.lineWidth=i,A(e,n);for(let t of n)le(e,t);e.restore()}function N(e,{text:t,at:[n,r],within:i,font:a}){if(e.font=a,i===void 0)return[n,r];let o=e.measureText(t).width/2;return[Math.min(Math.max(n,i[0]+o),i[1]-o),r]}function le(e,t){let n=N(e,t);e.textAlign=t.align,e.textBaseline=t.baseline,t.hasEdge===!0&&(e.lineJoin=`round`,e.strokeStyle=`rgba(5, 8, 16, 0.85)`,e.lineWidth=3.5,e.strokeText(t.text,...n)),e.fillStyle=j(t.ink),e.fillText(t.text,...n)}var P=[0,45,90,135,180,225,270,315],F=[0,30,60],ue=[226,234,255,.16],de=[170,182,211,1],fe=[234,240,255,1],pe=[234,240,255,.75],me=3,I=e=>({points:e,ink:ue,widthPx:1});function L(e,t,[n,r],i){let a=e%90==0;return{text:g(e),at:t,font:D(a?r:n,a?650:500),ink:a?fe:de,...i}}function he(e,t){let n={fisheye:_e,perspective:ve,equirectangular:ge}[e.name];return{...n(e,t),isClipped:e.name===`perspective`}}function ge(e,t){let n=t.leftPx+t.widthPx,r=t.topPx+t.heightPx,i=[],a=[];for(let o of[...F,90]){let{yPx:s}=e.pointFromDirection({azimuthDeg:0,elevationDeg:o}),c=[t.leftPx-6,Math.min(Math.max(s,t.topPx+6),r-5)];a.push({text:`${o}°`,at:c,font:D(11),ink:de,align:`right`,baseline:`middle`}),o!==0&&o!==90&&i.push(I([[t.leftPx,s],[n,s]]))}for(let n of[...P,360]){let{xPx:o}=e.pointFromDirection({azimuthDeg:n,elevationDeg:0}),s=n===0?`left`:n===360?`right`:`center`;a.push(L(n,[o,r+7],[11,13],{align:s,baseline:`top`})),n>0&&n<360&&i.push(I([[o,t.topPx],[o,r+(n%90==0?4:2)]]))}return{lines:i,names:a}}var R=(e,t)=>Array.from({length:(t-e)/me+1},(t,n)=>e+n*me),z=e=>R(0,360).map(t=>({azimuthDeg:t,elevationDeg:e})),B=e=>R(0,90).map(t=>({azimuthDeg:e,elevationDeg:t}));function _e(e,t){let n=Math.min(t.widthPx,t.heightPx)/2,r=[0,45,90,135].map(e=>[e,e+180].map(e=>B(e)[0])),i=[...F.map(z),...r].flatMap(t=>k(e,t)).map(I),a=P.map(t=>{let{xPx:r,yPx:i}=e.pointFromDirection({azimuthDeg:t,elevationDeg:-13/n*90});return L(t,[r,i],[11,13],{align:`center`,baseline:`middle`})});for(let t of[30,60]){let{xPx:n,yPx:r}=e.pointFromDirection({azimuthDeg:180,elevationDeg:t}),i=[n+4,r-7];a.push({text:`${t}°`,at:i,font:D(10),ink:pe,align:`left`,baseline:`middle`})}return{lines:i,names:a}}function ve(e){let t=[...F.map(z),...P.map(B)].flatMap(t=>k(e,t)).map(I),n=(t,n,r)=>{let{xPx:i,yPx:a}=e.pointFromDirection(t);return Number.isNaN(i)?[]:[[i+n,a+r]]},r=P.flatMap(e=>n({azimuthDeg:e,elevationDeg:0},0,6).map(t=>L(e,t,[12,14],{align:`center`,baseline:`top`,hasEdge:!0}))),i=[30,60].flatMap(e=>[0,90,180,270].flatMap(t=>n({azimuthDeg:t,elevationDeg:e},4,-2).map(t=>({text:`${e}°`,at:t,font:D(11),ink:pe,align:`left`,baseline:`bottom`}))));return{lines:t,names:[...r,...i]}}var V=class{gl;program;places=new Map;constructor(e,t,n){this.gl=e,this.program=e.createProgram();for(let[r,i]of[[e.VERTEX_SHADER,t],[e.FRAGMENT_SHADER,n]]){let t=e.createShader(r);if(t!==null){if(e.shaderSource(t,`#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\nprecision highp sampler2DArray;\n${i}`),e.compileShader(t),!e.getShaderParameter(t,e.COMPILE_STATUS)&&!e.isContextLost())throw Error(e.getShaderInfoLog(t)??``);e.attachShader(this.program,t),e.deleteShader(t)}}if(e.linkProgram(this.program),!e.getProgramParameter(this.program,e.LINK_STATUS)&&!e.isContextLost())throw Error(e.getProgramInfoLog(this.program)??``)}place(e){return this.places.has(e)||this.places.set(e,this.gl.getUniformLocation(this.program,e)),this.places.get(e)??null}};function H(e,t,n,r){return U(e,()=>{let i=t!==`R16F`;return e.texImage2D(e.TEXTURE_2D,0,e[t],...n,0,i?e.RGBA:e.RED,e.FLOAT,r),t===`RGBA32F`?e.NEAREST:e.LINEAR})}function ye(e,t){return U(e,()=>(e.pixelStorei(e.UNPACK_ALIGNMENT,1),e.texImage2D(e.TEXTURE_2D,0,e.RGB8,t.length/3,1,0,e.RGB,e.UNSIGNED_BYTE,new Uint8Array(t)),e.NEAREST))}function be(e,t){return U(e,()=>(e.pixelStorei(e.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!0),e.texImage2D(e.TEXTURE_2D,0,e.RGBA8,e.RGBA,e.UNSIGNED_BYTE,t),e.pixelStorei(e.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),e.LINEAR))}function xe(e,t){let n=e.createTexture(),r=e.TEXTURE_2D_ARRAY,{width:i=1,height:a=1}=t[0]??{};return e.activeTexture(e.TEXTURE0),e.bindTexture(r,n),e.texStorage3D(r,Math.floor(Math.log2(Math.max(i,a)))+1,e.SRGB8_ALPHA8,i,a,t.length),t.forEach((t,n)=>{e.texSubImage3D(r,0,0,0,n,i,a,1,e.RGBA,e.UNSIGNED_BYTE,t)}),e.generateMipmap(r),e.texParameteri(r,e.TEXTURE_MIN_FILTER,e.LINEAR_MIPMAP_NEAREST),e.texParameteri(r,e.TEXTURE_MAG_FILTER,e.LINEAR),e.texParameteri(r,e.TEXTURE_WRAP_S,e.CLAMP_TO_EDGE),e.texParameteri(r,e.TEXTURE_WRAP_T,e.CLAMP_TO_EDGE),n}function U(e,t){let n=e.createTexture();e.bindTexture(e.TEXTURE_2D,n);let r=t();return e.texParameteri(e.TEXTURE_2D,e.TEXTURE_MIN_FILTER,r),e.texParameteri(e.TEXTURE_2D,e.TEXTURE_MAG_FILTER,r),e.texParameteri(e.TEXTURE_2D,e.TEXTURE_WRAP_S,e.REPEAT),e.texParameteri(e.TEXTURE_2D,e.TEXTURE_WRAP_T,e.CLAMP_TO_EDGE),n}var Se=`// One colour, premultiplied.

uniform vec4 ink;
out vec4 colour;

void main() {
  colour = ink;
}
`,Ce=`// Ends of lines in CSS pixels from the upper left.

layout(location = 0) in vec2 at_px;
uniform vec2 canvas_px;

void main() {
  gl_Position = vec4((2.0 * at_px / canvas_px - 1.0) * vec2(1.0, -1.0), 0.0, 1.0);
}
`,we=`// A name that a canvas wrote.

uniform sampler2D written;
in vec2 within;
out vec4 colour;

void main() {
  colour = texture(written, within);
}
`,Te=`// A rectangle with a name: left, top, width and height in CSS pixels.

uniform vec4 box_px;
uniform vec2 canvas_px;
out vec2 within;

void main() {
  within = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = vec4((2.0 * (box_px.xy + within * box_px.zw) / canvas_px - 1.0) * vec2(1.0, -1.0), 0.0, 1.0);
}
`,Ee=96,W=6,De=class{gl;line;name;ends;array;written=new Map;page=document.createElement(`canvas`).getContext(`2d`,{willReadFrequently:!0});constructor(e){this.gl=e,this.line=new V(e,Ce,Se),this.name=new V(e,Te,we),this.ends=e.createBuffer(),this.array=e.createVertexArray(),e.bindVertexArray(this.array),e.bindBuffer(e.ARRAY_BUFFER,this.ends),e.enableVertexAttribArray(0),e.vertexAttribPointer(0,2,e.FLOAT,!1,0,0),e.bindVertexArray(null)}draw(e,t,n){let{gl:r}=this,{width:i,height:a}=r.canvas;r.viewport(0,0,i,a),r.enable(r.BLEND),r.blendEquation(r.FUNC_ADD),r.blendFunc(r.ONE,r.ONE_MINUS_SRC_ALPHA),r.bindVertexArray(this.array);for(let o of e){let[e,s,c,l]=[t.leftPx,a/n-t.topPx-t.heightPx,t.widthPx,t.heightPx].map(e=>Math.round(e*n));o.isClipped?r.scissor(e,s,c,l):r.scissor(0,0,i,a),this.drawLines(o,[i/n,a/n]),this.drawNames(o,[i/n,a/n],n)}r.bindVertexArray(null)}drawLines({lines:e},t){let{gl:n,line:r}=this,i=new Map;for(let{points:t,ink:n}of e){let e=i.get(n)??[];i.set(n,e),t.forEach((n,r)=>{let i=t[r-1];i!==void 0&&e.push(...i,...n)})}n.useProgram(r.program),n.uniform2f(r.place(`canvas_px`),...t),n.bindBuffer(n.ARRAY_BUFFER,this.ends);for(let[[e,t,a,o],s]of i){n.bufferData(n.ARRAY_BUFFER,new Float32Array(s),n.DYNAMIC_DRAW);let[i,c,l]=[e,t,a].map(e=>e/255*o);n.uniform4f(r.place(`ink`),i,c,l,o),n.drawArrays(n.LINES,0,s.length/2)}}drawNames({names:e},t,n){let{gl:r,name:i,page:a}=this;if(a!==null){r.useProgram(i.program),r.uniform2f(i.place(`canvas_px`),...t),r.activeTexture(r.TEXTURE0),r.uniform1i(i.place(`written`),0);for(let t of e){let{texture:e,widthPx:o,heightPx:s}=this.writing(a,t,n),[c,l]=N(a,t);r.bindTexture(r.TEXTURE_2D,e),r.uniform4f(i.place(`box_px`),c-o/2,l-s/2,o,s),r.drawArrays(r.TRIANGLE_STRIP,0,4)}}}writing(e,t,n){let r=[t.text,t.font,t.ink,t.align,t.baseline,n].join(),i=this.written.get(r);if(i!==void 0)return i;this.written.size>=Ee&&this.forget(),e.font=t.font;let{width:a,fontBoundingBoxAscent:o,fontBoundingBoxDescent:s}=e.measureText(t.text),[c,l]=[2*(a+W),2*(o+s+W)].map(e=>Math.ceil(e*n));e.canvas.width=c,e.canvas.height=l,e.setTransform(n,0,0,n,0,0);let[u,d]=[c/n,l/n],{within:f,...p}=t;le(e,{...p,at:[u/2,d/2]});let m={texture:be(this.gl,e.canvas),widthPx:u,heightPx:d};return this.written.set(r,m),m}forget(){for(let{texture:e}of this.written.values())this.gl.deleteTexture(e);this.written.clear()}},G=Math.PI/180,K=5,q=4,Oe=2,ke=65535,Ae=16,je=10,Me=.5;function Ne(e,{texels:t}){let{azimuthCount:n,elevationCount:r}=e,i=(e,r)=>{let i=4*(e*n+r%n);return[t[i]??0,t[i+1]??0,t[i+2]??0]},a=e=>{let t=i(r,e);return[90,...i(r-1,e).map((e,n)=>.5*(e+(t[n]??0)))]},o=t=>{let n=e.elevationFirstDeg+t*e.elevationStepDeg;return e=>[n,...i(t,e)]};return[e=>[0,...i(0,e)],...Array.from({length:r},(e,t)=>o(t)),a]}function Pe(e){let t=t=>Math.max(e.horizonDeg[t%e.azimuthCount]??0,0),n=e=>n=>[t(n)+e,e,0,0];return[e=>[-90,-90-t(e),0,0],n(-.5),n(Me)]}function Fe(e,{azimuthCount:t,azimuthFirstDeg:n,azimuthStepDeg:r},i){let a=t+1,o=new Float32Array(i.length*a*K);i.forEach((e,t)=>{for(let i=0;i<a;i++){let[s,...c]=e(i),l=(n+i*r)*G;o.set([l,s*G,...c],(t*a+i)*K)}});let{strips:s,corners:c}=Le(t,i.length),l=ze(e,o,[2,3]),u=e.createBuffer();return e.bindVertexArray(l.array),e.bindBuffer(e.ELEMENT_ARRAY_BUFFER,u),e.bufferData(e.ELEMENT_ARRAY_BUFFER,c,e.STATIC_DRAW),e.bindVertexArray(null),{...l,indices:u,columnCount:t,strips:s}}function Ie(e,t,{first:n,count:r},i){let{start:a,length:o,columns:s}=t.strips[+!!i],c=t.columnCount/s,l=Math.min(Math.ceil(r/s)+1,c),u=Math.floor((n%t.columnCount+t.columnCount)%t.columnCount/s);e.bindVertexArray(t.array);for(let[t,n]of[[u,Math.min(l,c-u)],[0,l-(c-u)]])n>0&&e.drawElements(e.TRIANGLE_STRIP,n*o,e.UNSIGNED_SHORT,Oe*(a+t*o));e.bindVertexArray(null)}function Le(e,t){let n=Array.from({length:t},(e,t)=>t),r=n.filter(e=>e<=je||e===t-1||e%2==0),i=[],a=(t,n)=>{let r=i.length;for(let r=0;r<e;r+=n){for(let a of t){let t=a*(e+1)+r;i.push(t,t+n)}i.push(ke)}return{start:r,length:2*t.length+1,columns:n}};return{strips:[a(n,1),a(r,e%2==0?2:1)],corners:Uint16Array.from(i)}}function Re({azimuthCount:e,azimuthStepDeg:t},n,r,i){let a={first:0,count:e};if(n.name!==`perspective`)return a;let{leftPx:o,topPx:s,widthPx:c,heightPx:l}=i,u=({xPx:e,yPx:t})=>e>=o&&e<=o+c&&t>=s&&t<=s+l;if([90,-90].some(e=>u(n.pointFromDirection({azimuthDeg:0,elevationDeg:e}))))return a;let[d,f]=[0,0];for(let e=0;e<=Ae;e++){let t=e/Ae;for(let[e,i]of[[t,0],[t,1],[0,t],[1,t]]){let t=n.directionFromPoint(o+e*c,s+i*l);if(t===null)continue;let a=(t.azimuthDeg-r.azimuthDeg+540)%360-180;[d,f]=[Math.min(d,a),Math.max(f,a)]}}let p=Math.floor((r.azimuthDeg+d)/t)-1;return{first:p,count:Math.min(Math.ceil((r.azimuthDeg+f)/t)+1-p,e)}}function ze(e,t,n){let r=e.createVertexArray(),i=e.createBuffer();e.bindVertexArray(r),e.bindBuffer(e.ARRAY_BUFFER,i),e.bufferData(e.ARRAY_BUFFER,t,e.STATIC_DRAW);let a=q*n.reduce((e,t)=>e+t,0),o=0;return n.forEach((t,n)=>{e.enableVertexAttribArray(n),e.vertexAttribPointer(n,t,e.FLOAT,!1,a,o),o+=q*t}),e.bindVertexArray(null),{array:r,vertices:i}}var Be=`// The light behind what stands before the sky.

/** X, Y, Z and scotopic luminance of the grid's samples with the veil, and of the highest row once more across the zenith. */
uniform sampler2D sky;
/** Luminance of the veil alone. */
uniform sampler2D veil;
/** The lower left corner of the plot on the canvas. */
uniform vec2 origin_px;

/** By bilinear interpolation, which textures of 32 bits have not. */
vec4 between_samples(sampler2D samples, vec2 direction) {
  ivec2 size = textureSize(samples, 0);
  vec2 at = place_of(direction, vec2(size)) * vec2(size) - 0.5;
  ivec2 low = ivec2(floor(at));
  vec2 part = at - vec2(low);
  #define TEXEL(right, above) texelFetch(samples, ivec2((low.x + right + size.x) % size.x, clamp(low.y + above, 0, size.y - 1)), 0)
  return mix(mix(TEXEL(0, 0), TEXEL(1, 0), part.x), mix(TEXEL(0, 1), TEXEL(1, 1), part.x), part.y);
}
`,Ve=`// Moon or Sun at its true size with its phase, and its glare, before the sky behind it.

/** Azimuth and elevation of its middle. */
uniform vec2 middle;
uniform float radius;
uniform vec4 lit;
uniform vec4 dark;
uniform float lit_share;
/** Direction of the bright limb, from up towards growing azimuth. */
uniform float bright_limb;
/** X, Y, Z and scotopic illuminance at the eye. */
uniform vec4 illuminance;
/** Whose veil the samples of the sky have; no more is drawn beyond it, and there is none for a camera: 0. */
uniform float halo_deg;
out vec4 colour;

/** Samples of a pixel along each side. */
const int SAMPLES = 4;
/** The twin of glare.ts. */
const float LEAST_DEG = 0.1;
const float AGEING = 1.0 + 0.48 * 0.48 * 0.48 * 0.48;
const float PIGMENT = 0.5;

float veil_facing(float angle_deg) {
  float theta = max(angle_deg, LEAST_DEG);
  float veil = 10.0 / (theta * theta * theta) + (5.0 / (theta * theta) + 0.1 * PIGMENT / theta) * AGEING + 0.0025 * PIGMENT;
  return veil * max(cos(radians(angle_deg)), 0.0);
}

void main() {
  vec3 ahead = vector_of(middle);
  vec3 right = vec3(cos(middle.x), -sin(middle.x), 0.0);
  vec3 above = vec3(-sin(middle.y) * vec2(sin(middle.x), cos(middle.x)), cos(middle.y));
  vec2 direction = direction_at(gl_FragCoord.xy - origin_px);
  // The chord tells small angles better than a cosine.
  float angle = 2.0 * asin(min(0.5 * length(vector_of(direction) - ahead), 1.0));
  float veil_deg = max(degrees(angle), degrees(radius));
  float more = veil_deg < halo_deg ? veil_facing(veil_deg) - veil_facing(halo_deg) : 0.0;
  vec4 sum = vec4(0.0);
  if (angle < 1.5 * radius + 2.0 * pixel_rad()) {
    for (int i = 0; i < SAMPLES * SAMPLES; i++) {
      vec2 inside = (vec2(i % SAMPLES, i / SAMPLES) + 0.5) / float(SAMPLES) - 0.5;
      vec3 away = vector_of(direction_at(gl_FragCoord.xy - origin_px + inside)) - ahead;
      vec2 on_disc = vec2(dot(away, right), dot(away, above)) / radius;
      if (dot(on_disc, on_disc) > 1.0 || dot(away, ahead) < -0.5) continue;
      float limb = on_disc.y * cos(bright_limb) + on_disc.x * sin(bright_limb);
      float along = on_disc.x * cos(bright_limb) - on_disc.y * sin(bright_limb);
      float terminator = (1.0 - 2.0 * lit_share) * sqrt(max(1.0 - along * along, 0.0));
      sum += limb >= terminator ? lit : dark;
    }
  }
  if (sum.y == 0.0 && more == 0.0) discard;
  vec4 veiled = between_samples(sky, direction) + more * illuminance;
  float dazzled = dazzle(veiled.y, between_samples(veil, direction).r + more * illuminance.y);
  colour = vec4(shown_light(veiled + sum / float(SAMPLES * SAMPLES), dazzled), 1.0);
}
`,He=`// One triangle over the whole plot; the scissors leave the square around the disc.

void main() {
  gl_Position = vec4(vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0), 0.0, 1.0);
}
`,Ue=`// Ground that hides the sky, smooth along its edge.

uniform vec3 ground;
in vec3 interpolated;
out vec4 colour;

void main() {
  float part = clamp(0.5 - interpolated.r / max(fwidth(interpolated.r), 1e-9), 0.0, 1.0);
  colour = vec4(ground * part, part);
}
`,J=`// From light to the display: the twins of eye.ts, realistic.ts and srgb.ts.

const int TABLE = 0;
const int FILM = 1;
const int EYE = 2;
const vec3 LUMINANCE_WEIGHTS = vec3(0.2126, 0.7152, 0.0722);
/** XYZ from linear sRGB primaries, D65 (IEC 61966-2-1), inverted. */
const mat3 SRGB_FROM_XYZ = mat3(3.2404542, -0.969266, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.041556, 1.0572252);
/** The same for a camera whose white is that of 4 200 K. */
const mat3 CAMERA_FROM_XYZ = mat3(3.0537492, -1.0011991, 0.0862492, -1.7256532, 1.9840248, -0.251268, -0.482897, 0.0275717, 1.6848894);
/** The film: contrast, shoulder, and what is white, in times middle grey. */
const float MIDDLE_GREY = 0.18;
const float FILM_CONTRAST = 1.15;
const float FILM_SHOULDER = 0.85;
const float FILM_WHITE = 1024.0;
const float WHITE_POWER = pow(FILM_WHITE, FILM_CONTRAST);
const float WHITE_SHOULDER = pow(WHITE_POWER, FILM_SHOULDER);
const float FILM_SLOPE = (WHITE_POWER * MIDDLE_GREY - 1.0) / ((WHITE_SHOULDER - 1.0) * MIDDLE_GREY);
const float FILM_TOE = (WHITE_SHOULDER - WHITE_POWER * MIDDLE_GREY) / ((WHITE_SHOULDER - 1.0) * MIDDLE_GREY);
/** V'(555 nm). */
const float SCOTOPIC_AT_555_NM = 683.0 / 1699.0;
const float RESPONSE_EXPONENT = 0.73;
const float ADAPTATION_EXPONENT = 0.8;
const float EQUIVALENT_BACKGROUND = 0.0025;
const float DARKEST = 1e-4;
const float CONTRAST_EXPONENT = 2.0;
/** X and Z over Y of what rods alone see: chromaticity (0.271, 0.276). */
const vec3 RODS = vec3(0.271 / 0.276, 1.0, (1.0 - 0.271 - 0.276) / 0.276);
const vec3 WHITE = vec3(0.3127 / 0.329, 1.0, (1.0 - 0.3127 - 0.329) / 0.329);
/** What the table spans: powers of ten of photopic luminance, and powers of two of scotopic over photopic, down to the same below 0. */
const float TABLE_FROM = -3.5;
const float TABLE_TO = 1.5;
const float TABLE_RATIO_LOG2 = 3.0;
/** The part of the cones. */
uniform sampler2D cone_table;

uniform int finish;
/** Of the eye, what the exposure makes of half of the brightest to the power of its response; of the film, the luminance of middle grey. */
uniform float exposure;
/** Luminance that the eye is adapted to. */
uniform float adaptation;

vec3 encoded(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(max(linear, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, linear));
}

/** Luminance and the part of the cones (CIE 191:2010, MES-2), by the table of eye.ts. */
vec2 mesopic(float photopic, float scotopic) {
  vec2 size = vec2(textureSize(cone_table, 0));
  vec2 at = vec2((log2(max(photopic, 1e-30)) * 0.30103 - TABLE_FROM) / (TABLE_TO - TABLE_FROM), 0.5 + 0.5 * log2(max(scotopic, 1e-30) / max(photopic, 1e-30)) / TABLE_RATIO_LOG2);
  float cones = texture(cone_table, (0.5 + clamp(at, 0.0, 1.0) * (size - 1.0)) / size).r;
  float rods = (1.0 - cones) * SCOTOPIC_AT_555_NM;
  return vec2((cones * photopic + rods * scotopic) / (cones + rods), cones);
}

/** How much more the eye is adapted to where a veil lies over a luminance, both together (eye.ts). */
float dazzle(float luminance, float veil) {
  return 1.0 + veil / max(luminance - veil, 1e-5);
}

/** Of light, where the eye is dazzled so many times. */
vec3 seen_by_eye(vec4 light, float dazzled) {
  vec2 seen = mesopic(light.y, light.w);
  float power = pow(max(seen.x, 1e-30), RESPONSE_EXPONENT);
  float half_power = exposure * pow(max(adaptation * dazzled, DARKEST) + EQUIVALENT_BACKGROUND, ADAPTATION_EXPONENT * RESPONSE_EXPONENT);
  float shown = pow(power / (power + half_power), CONTRAST_EXPONENT);
  vec3 rods = mix(RODS, WHITE, seen.y);
  vec3 cones = light.y > 0.0 ? light.xyz / light.y : rods;
  vec3 linear = SRGB_FROM_XYZ * (shown * mix(rods, cones, seen.y));
  // Towards grey of its own luminance until every channel is 0 to 1.
  vec3 away = abs(linear - shown);
  vec3 room = mix(vec3(shown), vec3(1.0 - shown), step(shown, linear));
  vec3 saturation = min(room / max(away, vec3(1e-12)), vec3(1.0));
  return clamp(shown + min(saturation.x, min(saturation.y, saturation.z)) * (linear - shown), 0.0, 1.0);
}

/** The film's curve, after colours outside sRGB moved towards grey. */
vec3 filmed(vec3 linear) {
  float grey = dot(LUMINANCE_WEIGHTS, linear);
  float lowest = min(linear.x, min(linear.y, linear.z));
  float saturation = lowest < 0.0 && grey > lowest ? grey / (grey - lowest) : 1.0;
  vec3 inside = max(grey + saturation * (linear - grey), 0.0);
  float brightest = max(inside.x, max(inside.y, inside.z));
  if (brightest <= 0.0) return vec3(0.0);
  float power = pow(min(brightest, FILM_WHITE), FILM_CONTRAST);
  float shown = power / (FILM_SLOPE * pow(power, FILM_SHOULDER) + FILM_TOE);
  return shown * mix(inside / brightest, vec3(1.0), pow(shown, 4.0));
}

/** What X, Y, Z and scotopic light look like where the eye is dazzled so many times. */
vec3 shown_light(vec4 light, float dazzled) {
  return encoded(finish == EYE ? seen_by_eye(light, dazzled) : filmed(CAMERA_FROM_XYZ * light.xyz / exposure));
}
`,We=`// A point of light blurred by the eye before the sky; the brighter of it and the sky is kept.

flat in vec4 peak;
flat in vec4 before;
flat in float dazzled;
flat in float blur_px;
flat in float size_px;
out vec4 colour;

void main() {
  vec2 away_px = (gl_PointCoord - 0.5) * size_px;
  float part = exp(-0.5 * dot(away_px, away_px) / (blur_px * blur_px));
  colour = vec4(shown_light(before + part * peak, dazzled), 1.0);
}
`,Ge=`// A star or planet as a square around where it is seen.

/** Azimuth and elevation. */
layout(location = 0) in vec2 direction;
/** X, Y, Z and scotopic illuminance, lx. */
layout(location = 1) in vec4 illuminance;
/** X, Y, Z and scotopic luminance of the sky there: the square is small beside its samples. */
layout(location = 2) in vec4 sky;
/** How much more the eye is adapted to there. */
layout(location = 3) in float dazzle_there;
flat out vec4 peak;
flat out vec4 before;
flat out float dazzled;
flat out float blur_px;
flat out float size_px;

/** Width of a star in the dark-adapted eye, standard deviation of a Gaussian. */
const float EYE_BLUR_RAD = 1.1e-3;
const float MIN_BLUR_PX = 0.6;
/** Light below this is not drawn, cd m-2: a tenth of the darkest sky. */
const float DARK_CD_M2 = 2e-5;
/** Nor what adds less than this part to the sky: no display shows it. */
const float UNSEEN_PART = 0.01;

void main() {
  blur_px = max(EYE_BLUR_RAD / pixel_rad(), MIN_BLUR_PX);
  peak = illuminance / (2.0 * PI * EYE_BLUR_RAD * EYE_BLUR_RAD);
  before = sky;
  dazzled = dazzle_there;
  float faintest = max(DARK_CD_M2, UNSEEN_PART * max(sky.y, sky.w));
  float brightest = max(max(peak.y, peak.w), faintest);
  size_px = 2.0 * ceil(blur_px * sqrt(2.0 * log(brightest / faintest)) + 0.5);
  gl_Position = clip_position(direction);
  gl_PointSize = size_px;
}
`,Ke=`// The sky between the samples of the grid: colours, or places in a colour table.

uniform sampler2D table;
in vec3 interpolated;
out vec4 colour;

/** Half a step of the display to either side, so that dark skies have no bands (interleaved gradient noise, Jimenez 2014). */
float noise(vec2 at_px) {
  return (fract(52.9829189 * fract(dot(at_px, vec2(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

void main() {
  colour = vec4(interpolated + noise(gl_FragCoord.xy), 1.0);
  if (finish == TABLE) colour = texelFetch(table, ivec2(clamp(interpolated.r, 0.0, 1.0) * float(textureSize(table, 0).x - 1) + 0.5, 0), 0);
}
`,Y=`// Samples of the sky and points of the ground, where the projection has them.

/** Azimuth and elevation. */
layout(location = 0) in vec2 direction;
/** Red, green and blue of the sky as the display takes them; of the ground how many degrees above its edge it lies. */
layout(location = 1) in vec3 shown;
out vec3 interpolated;

void main() {
  vec2 there = projection == PERSPECTIVE ? direction : vec2(direction.x, max(direction.y, 0.0));
  // No sky is moved by this, and ground to where it still is as far from its edge as it says.
  interpolated = shown + vec3(degrees(there.y - direction.y), 0.0, 0.0);
  gl_Position = clip_position(there);
}
`,X=`// Directions from pixels and back. The twin of projection.ts; angles in radians, pixels from the lower left of the plot.

const int EQUIRECTANGULAR = 0;
const int FISHEYE = 1;
const int PERSPECTIVE = 2;
const float PI = 3.14159265358979;

uniform int projection;
/** Width and height of the plot. */
uniform vec2 plot_px;
/** Columns right, above and ahead of the perspective, in (east, north, up). */
uniform mat3 camera;
/** Distance from the eye to the plot. */
uniform float focal_px;

/** Azimuth and elevation at a position; y is NaN-free: outside a fisheye the elevation is below the horizon. */
vec2 direction_at(vec2 at_px) {
  vec2 away_px = at_px - 0.5 * plot_px;
  if (projection == EQUIRECTANGULAR) return vec2(at_px.x / plot_px.x * 2.0 * PI, at_px.y / plot_px.y * 0.5 * PI);
  if (projection == FISHEYE) {
    float radius_px = 0.5 * min(plot_px.x, plot_px.y);
    return vec2(atan(-away_px.x, away_px.y), 0.5 * PI * (1.0 - length(away_px) / radius_px));
  }
  vec3 enu = camera * vec3(away_px, focal_px);
  return vec2(atan(enu.x, enu.y), atan(enu.z, length(enu.xy)));
}

/** East, north, up. */
vec3 vector_of(vec2 direction) {
  return vec3(cos(direction.y) * vec2(sin(direction.x), cos(direction.x)), sin(direction.y));
}

/** Where a direction lies on the plot. */
vec4 clip_position(vec2 direction) {
  if (projection == EQUIRECTANGULAR) return vec4(direction.x / PI - 1.0, direction.y / (0.25 * PI) - 1.0, 0.0, 1.0);
  if (projection == FISHEYE) {
    float distance_px = (1.0 - direction.y / (0.5 * PI)) * min(plot_px.x, plot_px.y);
    return vec4(distance_px * vec2(-sin(direction.x), cos(direction.x)) / plot_px, 0.0, 1.0);
  }
  vec3 local = vector_of(direction) * camera;
  return vec4(2.0 * focal_px * local.xy / plot_px, 0.0, local.z);
}

/** Where a direction lies on textures of the grid: column 0 looks north, row 0 is half a row above the horizon. */
vec2 place_of(vec2 direction, vec2 size) {
  return vec2(direction.x / (2.0 * PI) + 0.5 / size.x, direction.y / (0.5 * PI) * (size.y - 1.0) / size.y);
}

/** Angle that a pixel in the middle of the plot subtends along its height. */
float pixel_rad() {
  if (projection == EQUIRECTANGULAR) return 0.5 * PI / plot_px.y;
  return projection == FISHEYE ? PI / min(plot_px.x, plot_px.y) : 1.0 / focal_px;
}
`,qe=[`table`,`realistic`,`eye`],Z=Math.PI/180,Je=class{canvas=document.createElement(`canvas`);gl;programs=null;uploads=new Map;lands=new Map;constructor(e){let{canvas:t}=this;this.gl=t.getContext(`webgl2`,{alpha:!1,antialias:!1,depth:!1}),t.addEventListener(`webglcontextlost`,t=>{t.preventDefault(),this.programs=null,this.uploads.clear(),this.lands.clear(),e()}),t.addEventListener(`webglcontextrestored`,e)}get isReady(){return this.gl!==null&&!this.gl.isContextLost()}begin(e,t){let{canvas:n,gl:r}=this;if(n.width!==e&&(n.width=e),n.height!==t&&(n.height=t),r===null)return;r.disable(r.SCISSOR_TEST);let[i=0,a=0,o=0]=(getComputedStyle(n).color.match(/\d+/g)??[]).map(e=>Number(e)/255);r.clearColor(i,a,o,1),r.clear(r.COLOR_BUFFER_BIT)}paint(e,t,n,r,i){let{gl:a}=this;if(a===null)return;this.programs??={sky:new V(a,X+Y,J+Ke),ground:new V(a,X+Y,Ue),land:null,point:new V(a,X+Ge,J+We),disc:new V(a,He,X+Be+J+Ve),lines:new De(a),cones:H(a,`R16F`,[ee.width,ee.height],T())};let o=this.uploaded(a,e,t),{leftPx:s,topPx:c,widthPx:l,heightPx:u}=n.plot,d=n.pixelsPerCssPx,f=[s,this.canvas.height/d-c-u,l,u].map(e=>Math.round(e*d)),[p,m,h,g]=f;a.enable(a.SCISSOR_TEST),a.viewport(p,m,h,g),a.scissor(p,m,Math.max(Math.min(h,r-p),0),g),a.disable(a.BLEND);let _=e=>this.use(a,e,t,n,f),v=_(this.programs.sky);o.table!==null&&Q(a,v,`table`,0,o.table);let y=Re(e,n.projection,n.gaze,n.plot);if(Ie(a,o.sky,y,n.isMoving),a.enable(a.BLEND),o.before!==null&&this.paintBefore(a,this.programs,o.before,{grid:e,plot:n,area:f,use:_,untilPx:r,isEye:t.colours===`eye`}),a.scissor(p,m,Math.max(Math.min(h,r-p),0),g),a.blendEquation(a.FUNC_ADD),a.blendFunc(a.ONE,a.ONE_MINUS_SRC_ALPHA),i===null){let e=_(this.programs.ground),[t,n,r]=o.shading.groundRgb;a.uniform3f(e.place(`ground`),t/255,n/255,r/255)}else this.programs.land??=new V(a,X+Y,X+J+i.fragmentShader),Q(a,_(this.programs.land),`faces`,0,this.uploadedLand(a,i),a.TEXTURE_2D_ARRAY);Ie(a,o.ground,y,!1)}drawOver(e,t,n){this.programs?.lines.draw(e,t,n)}paintBefore(e,{point:t,disc:n,cones:r},{points:i,sky:a,veil:o},{grid:s,plot:c,area:l,use:u,untilPx:d,isEye:f}){let[p,m,h,g]=l,_=c.pixelsPerCssPx;e.disable(e.BLEND);for(let t of s.discs){let i=f&&t.elevation_deg>=Math.max(s.horizonAt(t.azimuth_deg),0)?5:0,{xPx:l,yPx:v}=c.projection.pointFromDirection({azimuthDeg:t.azimuth_deg,elevationDeg:t.elevation_deg});if(Number.isNaN(l))continue;let y=Ye(t,c,i)*_,b=[l*_-y,this.canvas.height-v*_-y].map(Math.floor),x=Math.max(b[0]??0,p),S=Math.max(b[1]??0,m),C=Math.min((b[0]??0)+2*y,p+h,d),w=Math.min((b[1]??0)+2*y,m+g);e.scissor(x,S,Math.max(C-x,0),Math.max(w-S,0));let T=u(n);Q(e,T,`sky`,0,a),Q(e,T,`veil`,2,o),Q(e,T,`cone_table`,1,r),Xe(e,T,t,i)}e.scissor(p,m,Math.max(Math.min(h,d-p),0),g),e.enable(e.BLEND),e.blendEquation(e.MAX),Q(e,u(t),`cone_table`,1,r),e.bindVertexArray(i.array),e.drawArrays(e.POINTS,0,s.points.length),e.bindVertexArray(null)}use(e,t,{colours:n,exposureEv:r,adaptationCdM2:i},{projection:a,gaze:o},[s,c,l,u]){e.useProgram(t.program),e.uniform1i(t.place(`projection`),d.indexOf(a.name)),e.uniform2f(t.place(`plot_px`),l,u),e.uniform2f(t.place(`origin_px`),s,c),e.uniformMatrix3fv(t.place(`camera`),!1,Ze(o)),e.uniform1f(t.place(`focal_px`),u/2/Math.tan(o.fieldDeg/2*Z)),e.uniform1i(t.place(`finish`),m(n)?qe.indexOf(n):qe.indexOf(`table`));let f=n===`eye`;return e.uniform1f(t.place(`exposure`),f?S(r):b(r)),e.uniform1f(t.place(`adaptation`),i??0),t}uploaded(e,t,n){let r=JSON.stringify(n),i=this.uploads.get(t);if(i?.look===r)return i;i!==void 0&&this.release(e,t,i);for(let[t,n]of[...this.uploads].slice(0,-1))this.release(e,t,n);let a=v(t,n),o=m(n.colours)&&n.sky===`total`&&t.points.length+t.discs.length>0,s={look:r,shading:a,table:m(n.colours)?null:ye(e,E(n.colours)),sky:Fe(e,t,Ne(t,a)),ground:Fe(e,t,Pe(t)),before:o?Qe(e,t,n):null};return this.uploads.set(t,s),s}uploadedLand(e,t){let n=this.lands.get(t);if(n!==void 0)return n;for(let[t,n]of[...this.lands].slice(0,-1))e.deleteTexture(n),this.lands.delete(t);let r=xe(e,t.faces);return this.lands.set(t,r),r}release(e,t,{table:n,sky:r,ground:i,before:a}){for(let t of[n,a?.sky,a?.veil])e.deleteTexture(t??null);for(let{array:t}of[r,i,...a===null?[]:[a.points]])e.deleteVertexArray(t);for(let t of[r.vertices,r.indices,i.vertices,i.indices,a?.points.vertices])e.deleteBuffer(t??null);this.uploads.delete(t)}};function Q(e,t,n,r,i,a=e.TEXTURE_2D){e.activeTexture(e.TEXTURE0+r),e.bindTexture(a,i),e.uniform1i(t.place(n),r)}function Ye({radius_deg:e,elevation_deg:t},{projection:n,gaze:r,plot:{widthPx:i,heightPx:a}},o){let s={equirectangular:90/a,fisheye:180/Math.min(i,a),perspective:2*Math.tan(r.fieldDeg/2*Z)/a/Z}[n.name];return 4+2/Math.max(Math.cos(t*Z),.05)*Math.max(e,o)/s}function Xe(e,t,n,r){e.uniform2f(t.place(`middle`),n.azimuth_deg*Z,n.elevation_deg*Z),e.uniform1f(t.place(`radius`),n.radius_deg*Z),e.uniform4fv(t.place(`lit`),n.lit_cd_m2),e.uniform4fv(t.place(`dark`),n.dark_cd_m2),e.uniform1f(t.place(`lit_share`),n.lit_share),e.uniform1f(t.place(`bright_limb`),n.bright_limb_deg*Z),e.uniform4fv(t.place(`illuminance`),x(n)),e.uniform1f(t.place(`halo_deg`),r),e.drawArrays(e.TRIANGLES,0,3)}function Ze(e){let t=e.azimuthDeg*Z,n=p({azimuthDeg:e.azimuthDeg,elevationDeg:e.elevationDeg+90});return[Math.cos(t),-Math.sin(t),0,...n,...p(e)]}function Qe(e,t,{sky:n,colours:r}){let i=Array.from({length:t.azimuthCount*t.elevationCount},(e,i)=>r===`eye`?y(t,n,i):{light:t.eyeAt(n,i),veilCdM2:0}),a=ne(t,e=>i[e]?.light??[]),o=ne(t,e=>[i[e]?.veilCdM2??0]),s=[t.azimuthCount,t.elevationCount+1],c=t.points.flatMap(({azimuthDeg:e,elevationDeg:n,illuminanceLx:r})=>[e*Z,n*Z,...r,...t.between(a,e,n),C(t.between(a,e,n)[1],t.between(o,e,n)[0])]);return{sky:H(e,`RGBA32F`,s,a),veil:H(e,`RGBA32F`,s,o),points:ze(e,new Float32Array(c),[2,4,4,1])}}function $e(e,t){return t.horizonDeg.some(e=>e>0)?k(e,Array.from({length:t.azimuthCount+1},(e,n)=>{let r=t.azimuthFirstDeg+n*t.azimuthStepDeg;return{azimuthDeg:r,elevationDeg:Math.max(t.horizonAt(r),0)}})).map(e=>({points:e,ink:[164,156,144,1],widthPx:1.2})):[]}function et(e,t,n,r,i){let a=e.name===`fisheye`?9:17/t.heightPx*n,o=t.leftPx+t.widthPx,s=[],c=[];for(let{name:n,azimuthDeg:l}of i){let i=Math.max(r.horizonAt(l),0),u=e.pointFromDirection({azimuthDeg:l,elevationDeg:i}),d=e.pointFromDirection({azimuthDeg:l,elevationDeg:i+a});if(!(d.xPx>t.leftPx&&d.xPx<o&&d.yPx<t.topPx+t.heightPx))continue;let f=[u.xPx+.45*(d.xPx-u.xPx),u.yPx+.45*(d.yPx-u.yPx)];s.push({points:[[u.xPx,u.yPx],f],ink:[5,8,16,.85],widthPx:1});let p=[t.leftPx+3,o-3],m={font:D(11,550),ink:[255,255,255,1],align:`center`,baseline:`middle`,hasEdge:!0};c.push({text:n,at:[d.xPx,d.yPx],within:p,...m})}return{lines:s,names:c,isClipped:!1}}var tt=24,nt=10,rt=5;function it(e,t,n,r,{name:i,azimuthDeg:a}){let o=Math.max(r.horizonAt(a),0),[s,c]=[tt,nt].map(e=>t.pointFromDirection({azimuthDeg:a,elevationDeg:Math.min(o+e,90)}));if(s===void 0||c===void 0||Number.isNaN(s.xPx+c.xPx))return;let l=Math.max(Math.hypot(c.xPx-s.xPx,c.yPx-s.yPx),1),[u,d]=[(c.xPx-s.xPx)/l,(c.yPx-s.yPx)/l];e.save(),O(e,n),e.font=D(13,650),e.textAlign=`center`,e.textBaseline=`middle`,e.lineJoin=`round`;let f=e.measureText(i).width/2+3,p=Math.min(Math.max(s.xPx-12*u,n.leftPx+f),n.leftPx+n.widthPx-f),m=Math.max(s.yPx-12*d,n.topPx+9);e.strokeStyle=`rgba(0, 0, 0, 0.85)`,e.lineWidth=4,e.strokeText(i,p,m),e.fillStyle=`#6ff0dc`,e.fillText(i,p,m);for(let[t,n]of[[`rgba(0, 0, 0, 0.75)`,5],[`#6ff0dc`,2]]){e.strokeStyle=t,e.lineWidth=n,A(e,[[s.xPx,s.yPx],[c.xPx,c.yPx]]);for(let t of[-1,1])A(e,[[c.xPx-rt*(u+t*d),c.yPx-rt*(d-t*u)],[c.xPx,c.yPx]])}e.restore()}function at(t,n,r,i,a){let o=a?e(i):i;t.save(),n.name===`perspective`&&O(t,r),t.lineJoin=`round`;for(let[e,r]of[[`rgba(0, 0, 0, 0.75)`,4.5],[`#6ff0dc`,2]])t.strokeStyle=e,t.lineWidth=r,se(t,n,o);t.restore()}function ot(e,t,n){let{xPx:r,yPx:i}=t.pointFromDirection(n);for(let[t,n]of[[`rgba(0, 0, 0, 0.7)`,4],[`#ffffff`,1.6]]){e.strokeStyle=t,e.lineWidth=n,e.beginPath(),e.arc(r,i,6,0,2*Math.PI),e.stroke();for(let[t,n]of[[1,0],[-1,0],[0,1],[0,-1]])A(e,[[r+6*t,i+6*n],[r+11*t,i+11*n]])}}var $=[2,1.5,1,.75,.5,.35],st=31,ct=19,lt=4,ut=30,dt=400,ft=4e3,pt=16e5,mt=class{step=$.indexOf(1);finest=0;lastMs=null;wasVerySlow=!1;isBegun=!1;times=[];scale(e,t){if(!this.isBegun){this.isBegun=!0;let e=$.findIndex(e=>e<=1&&e**2*t<=pt);this.step=e<0?$.length-1:e}return Math.min($[this.step]??1,e)}frame(e){let t=this.lastMs===null?1/0:e-this.lastMs;if(this.lastMs=e,t>dt){this.times=[];let e=t<ft;e&&this.wasVerySlow&&(this.finest=Math.min(this.step+1,$.length-1),this.moveTo(this.finest)),this.wasVerySlow=e;return}this.wasVerySlow=!1,this.times.push(t);let{times:n}=this,r=n.reduce((e,t)=>e+t,0)/n.length;n.length>=lt&&r>st?(this.finest=Math.min(this.step+1,$.length-1),this.moveTo(this.finest)):n.length>=ut&&this.moveTo(r<ct?Math.max(this.step-1,this.finest):this.step)}moveTo(e){this.step=e,this.times=[]}};function ht(e,{texels:t},n,r){let{azimuthCount:i,elevationCount:a}=e,o=(n-e.azimuthFirstDeg)/e.azimuthStepDeg+i,s=Math.min(Math.max((r-e.elevationFirstDeg)/e.elevationStepDeg,0),a-.5),[c,l]=[Math.floor(o),Math.min(Math.floor(s),a-1)],[u,d]=[o-c,s-l],f=(e,t)=>4*(e*i+t%i),[p,m,h,g]=[f(l,c),f(l,c+1),f(l+1,c),f(l+1,c+1)],_=e=>(1-d)*((1-u)*(t[p+e]??0)+u*(t[m+e]??0))+d*((1-u)*(t[h+e]??0)+u*(t[g+e]??0));return[_(0),_(1),_(2)]}function gt({isTable:e},t){if(!e)return e=>e.map(e=>255*e);let n=E(t);return([e])=>{let t=3*Math.round(Math.min(Math.max(e,0),1)*(te-1));return n.subarray(t,t+3)}}function _t(e,t,n,r,i,a=null){let o=v(t,n),s=gt(o,n.colours),{data:c}=e;for(let n=0;n<e.height;n++)for(let l=0;l<e.width;l++){let u=(n*e.width+l)*4,d=r.directionFromPoint((l+.5)/i,(n+.5)/i);if(d===null)continue;let{azimuthDeg:f,elevationDeg:p}=d,m=p<Math.max(t.horizonAt(f),0)?a?.rgbAt(d)??o.groundRgb:s(ht(t,o,f,p));c.set(m,u),c[u+3]=255}}var vt=3,yt=.01,bt=9;function xt(e,t){return e*t**-2.5}function St(e,t,n){let r=t.map(t=>({town:t,...a(e,t)})).filter(({town:e,distanceKm:t})=>(e.population??0)>0&&t>vt).map(({town:e,distanceKm:t,bearingDeg:n})=>({name:e.name,azimuthDeg:n,distanceKm:t,glow:xt(e.population??0,t)})).sort((e,t)=>t.glow-e.glow),i=(r[0]?.glow??0)*yt,o=[];for(let{glow:e,...t}of r){if(e<i||o.length===bt)break;o.every(({azimuthDeg:e})=>Math.abs((e-t.azimuthDeg+540)%360-180)>=n)&&o.push(t)}return o}var Ct=74,wt=2,Tt=40,Et=e=>({left:e,right:e,top:e,bottom:e}),Dt={equirectangular:{left:34,right:8,top:8,bottom:28},fisheye:Et(26),perspective:Et(8)},Ot=class{picture=document.createElement(`canvas`);overlay=document.createElement(`canvas`);get canvases(){return[this.gpu.canvas,this.picture,this.overlay]}plot={leftPx:0,topPx:0,widthPx:1,heightPx:1};projection=null;scale=1;pace=new mt;towns=null;isMarked=!1;gpu;constructor(e){this.gpu=new Je(e),this.picture.className=`sky-picture`,this.gpu.canvas.setAttribute(`aria-hidden`,`true`),this.setMoving(!1),this.picture.setAttribute(`aria-hidden`,`true`),this.overlay.className=`sky-overlay`,this.overlay.tabIndex=0,this.overlay.setAttribute(`role`,`application`),this.overlay.setAttribute(`aria-roledescription`,u().sky.pictureKind),this.overlay.setAttribute(`aria-describedby`,`sky-readout`),this.overlay.setAttribute(`aria-label`,u().sky.picture)}draw(e,t,n){let r=Math.min(window.devicePixelRatio||1,wt),i=this.place(e,t);if(i===null)return;let{projection:a,plot:o}=i;this.scale=r;let[s,c]=[i.widthPx,i.heightPx].map(e=>Math.round(e*r));for(let e of[this.picture,this.overlay])e.width!==s&&(e.width=s),e.height!==c&&(e.height=c);let l=this.picture.getContext(`2d`);if(l!==null){l.clearRect(0,0,s,c),t.grid!==null&&this.drawSkies(l,t.grid,t,a),l.setTransform(r,0,0,r,0,0);for(let e of this.drawings(t,a))M(l,e,o);l.setTransform(1,0,0,1,0,0),this.setMoving(!1),this.drawMarks(t.grid,n)}}drawMoving(t,n,{trail:r,region:i}){let{gpu:a,pace:o}=this,{grid:s}=n;if(s===null||!a.isReady)return!1;let c=this.place(t,n);if(c===null)return!1;let{projection:l,plot:u}=c;o.frame(performance.now());let d=o.scale(window.devicePixelRatio||1,c.widthPx*c.heightPx),[f,p]=[c.widthPx,c.heightPx].map(e=>Math.round(e*d)),m=this.paintSkies(s,n,{projection:l,plot:u,gaze:n.gaze,pixelsPerCssPx:d,isMoving:!0},[f,p]),h={lines:[...k(l,r??(i===null?null:e(i))??[]).map(e=>({points:e,ink:[111,240,220,1],widthPx:2})),...m===null?[]:[jt(u,m/d)]],names:[],isClipped:!0};return a.drawOver([...this.drawings(n,l),h],u,d),this.setMoving(!0),!0}setMoving(e){this.picture.style.visibility=e?`hidden`:`visible`,this.gpu.canvas.style.visibility=e?`visible`:`hidden`,this.overlay.style.opacity=e?`0`:`1`}place(e,t){let n=Math.floor(e.clientWidth),r=Math.floor(e.clientHeight);if(n<Tt||r<Tt)return null;let{left:i,right:a,top:o,bottom:s}=Dt[t.projection],c={leftPx:i,topPx:o,widthPx:n-i-a,heightPx:r-o-s},l={equirectangular:f,fisheye:h,perspective:_}[t.projection](c,t.gaze);return this.plot=c,this.projection=l,{projection:l,plot:c,widthPx:n,heightPx:r}}drawings(e,t){let{plot:n}=this,{grid:r}=e,i=he(t,n);if(r===null)return[i];let a=e.colours===`eye`||e.landscape!==null?[]:$e(t,r),o=e.projection===`perspective`?e.gaze.fieldDeg:90;return[i,{lines:a,names:[],isClipped:t.name===`perspective`},et(t,n,o,r,this.townsOf(e))]}townsOf(e){let{place:t,places:n}=e;if(t===null)return[];let r=this.minSeparationDeg(e),{towns:i}=this;if(i?.place===t&&i.places===n&&i.minSeparationDeg===r)return i.found;let a=St(t,n,r);return this.towns={place:t,places:n,minSeparationDeg:r,found:a},a}drawMarks(e,{trail:t,region:n,pointed:r,town:i}){let a=this.overlay.getContext(`2d`);if(a===null||this.projection===null)return;let o=e!==null&&(t??n??r??i)!==null;(o||this.isMarked)&&a.clearRect(0,0,this.overlay.width,this.overlay.height),this.isMarked=o,o&&(a.setTransform(this.scale,0,0,this.scale,0,0),t===null?n!==null&&at(a,this.projection,this.plot,n,!0):at(a,this.projection,this.plot,t,!1),i!==null&&it(a,this.projection,this.plot,e,i),r!==null&&ot(a,this.projection,e.nearest(r.azimuthDeg,r.elevationDeg)),a.setTransform(1,0,0,1,0,0))}directionAt(e,t){let n=this.projection?.directionFromPoint(e,t)??null;return n!==null&&n.elevationDeg<0?null:n}shows(e){let t=this.projection?.pointFromDirection(e);if(t===void 0)return!1;let{leftPx:n,topPx:r,widthPx:i,heightPx:a}=this.plot;return t.xPx>n&&t.xPx<n+i&&t.yPx>r&&t.yPx<r+a}drawSkies(e,t,n,r){let{scale:i,gpu:a}=this,{width:o,height:s}=this.picture,c;if(a.isReady){let{plot:l}=this;c=this.paintSkies(t,n,{projection:r,plot:l,gaze:n.gaze,pixelsPerCssPx:i,isMoving:!1},[o,s]),e.drawImage(a.canvas,0,0)}else{c=this.splitPx(n,i);for(let[a,l,u]of At(t,n,c,o)){let o=e.createImageData(l,s);_t(o,a,kt(t,n),r,i,u),e.putImageData(o,0,0)}}c!==null&&(e.setTransform(i,0,0,i,0,0),M(e,{lines:[jt(this.plot,c/i)],names:[],isClipped:!1},this.plot),e.setTransform(1,0,0,1,0,0))}paintSkies(e,t,n,[r,i]){let a=kt(e,t),o=this.splitPx(t,n.pixelsPerCssPx);this.gpu.begin(r,i);for(let[i,s,c]of At(e,t,o,r))this.gpu.paint(i,a,n,s,c);return o}splitPx({other:e,split:t},n){let r=Math.round((this.plot.leftPx+t*this.plot.widthPx)*n);return e===null||r<1?null:r}minSeparationDeg({projection:e,gaze:t}){let{widthPx:n,heightPx:r}=this.plot;if(e===`perspective`)return Ct/r*t.fieldDeg;let i=e===`fisheye`?Math.PI*Math.min(n,r):n;return Math.min(Ct/i*360,90)}};function kt(e,t){let{sky:n,colours:r,exposureEv:i}=t;return{sky:n,colours:r,exposureEv:i,adaptationCdM2:r===`eye`?w(e,t,t.landCdM2):null}}function At(e,{other:t,landscape:n,otherLandscape:r},i,a){let o=[e,a,n];return t===null||i===null?[o]:[o,[t,i,r]]}function jt({topPx:e,heightPx:t},n){return{points:[[n,e],[n,e+t]],ink:[255,255,255,1],widthPx:1}}var Mt=200,Nt=class{container;store;canvas=new Ot(()=>this.drawSoon());drawing=new oe;gaze=null;draggedFrom=null;fingers=new Map;pointed=null;isDrawnSoon=!1;sharpenSoon=r(Mt,()=>this.draw());constructor(e,n){this.container=e,this.store=n;let{overlay:r,canvases:a}=this.canvas;e.append(i(`div`,`sky-canvases`,...a)),this.listen(r),n.watch([`gaze`],({gaze:e})=>{e!==this.gaze&&(this.gaze=e,this.isPerspective()&&this.redraw())});let o=[`panorama`,`panoramaToday`,`projection`,`sky`,`colours`,`exposureEv`,`adaptationCdM2`,`landscape`,`landscapeToday`,t,`places`];n.watch(o,()=>this.redraw()),n.watch([`split`],({panoramaToday:e})=>{e!==null&&this.drawSoon()}),n.watch([`region`,`shownTown`],()=>this.drawMarks()),n.watch([`isDrawing`],({isDrawing:e})=>{this.drawing.set(e),r.classList.toggle(`drawing`,e),e&&r.focus(),this.drawMarks()}),new ResizeObserver(()=>this.draw()).observe(e)}listen(e){e.addEventListener(`pointermove`,e=>{this.pinch(e)||this.turn(e)||(this.pointAt(e),e.buttons!==0&&this.extendCurve())}),e.addEventListener(`pointerdown`,t=>{let n=[t.offsetX,t.offsetY];if(this.fingers.set(t.pointerId,n),!t.isPrimary||t.button!==0)return;this.pointAt(t);let r=this.drawing.trail!==null;(r||this.isPerspective())&&(e.setPointerCapture(t.pointerId),r?(this.drawing.restart(),this.extendCurve()):this.draggedFrom=n)}),e.addEventListener(`pointerup`,e=>{this.fingers.delete(e.pointerId),e.isPrimary&&(this.endTurn(),this.finishCurve(this.drawing.close()))}),e.addEventListener(`pointercancel`,e=>{this.fingers.delete(e.pointerId),this.endTurn(),this.drawing.restart(),this.drawMarks()}),e.addEventListener(`wheel`,e=>{this.isPerspective()&&(e.preventDefault(),this.zoom(e.deltaY>0?l:1/l))},{passive:!1}),e.addEventListener(`pointerleave`,e=>{e.pointerType===`mouse`&&this.setPointed(null)}),e.addEventListener(`keydown`,e=>this.keyPressed(e))}isPerspective(){return this.store.state.projection===`perspective`}currentGaze(){return s(this.gaze,this.store.state.panorama)}redraw(){this.draw(),this.announce()}draw(){this.canvas.draw(this.container,this.scene(),this.marks()),this.store.set({skyAspect:this.canvas.plot.widthPx/this.canvas.plot.heightPx})}scene(){let{state:e}=this.store;return{...e,grid:e.panorama,other:e.panoramaToday,otherLandscape:e.landscapeToday,landCdM2:t(e),gaze:this.currentGaze()}}drawSoon(){this.isDrawnSoon||(this.isDrawnSoon=!0,requestAnimationFrame(()=>{this.isDrawnSoon=!1,this.canvas.drawMoving(this.container,this.scene(),this.marks())?this.sharpenSoon():this.draw()}))}drawMarks(){this.canvas.drawMarks(this.store.state.panorama,this.marks())}marks(){let{region:e,place:t,shownTown:n}=this.store.state,r=t===null||n===null?null:{name:n.name,azimuthDeg:a(t,n).bearingDeg};return{trail:this.drawing.trail,region:e,pointed:this.pointed,town:r}}pinch({pointerId:e,offsetX:t,offsetY:n}){let r=this.fingers.get(e);if(r===void 0)return!1;let i=[t,n];this.fingers.set(e,i);let a=[...this.fingers].find(([t])=>t!==e)?.[1];if(a===void 0||!this.isPerspective())return!1;let o=([e,t])=>Math.max(Math.hypot(e-a[0],t-a[1]),1);return this.zoom(o(r)/o(i)),this.draggedFrom=null,!0}turn({offsetX:e,offsetY:t}){if(this.draggedFrom===null)return!1;let[n,r]=this.draggedFrom;return this.gaze=c(this.currentGaze(),e-n,t-r,this.canvas.plot.heightPx),this.draggedFrom=[e,t],this.drawSoon(),!0}endTurn(){this.draggedFrom!==null&&(this.draggedFrom=null,this.draw(),this.lookAt(this.currentGaze()))}zoom(e){this.lookAt(o(this.currentGaze(),e)),this.drawSoon()}lookAt(e){this.gaze=e,this.store.set({gaze:e})}pointAt({offsetX:e,offsetY:t}){this.setPointed(this.canvas.directionAt(e,t))}setPointed(e){this.pointed=e,this.drawMarks(),this.announce()}announce(){let{pointed:e}=this,{panorama:t}=this.store.state,n=e===null||t===null?null:t.nearest(e.azimuthDeg,e.elevationDeg);this.store.set({pointed:n})}extendCurve(){this.drawing.trail!==null&&(this.drawing.extend(this.pointed),this.drawMarks())}finishCurve(e){e===null?this.drawMarks():(this.store.set({isDrawing:!1}),this.store.markRegion(e))}keyPressed(e){let{panorama:t}=this.store.state;if(e.key===`Escape`){this.drawing.trail===null?this.setPointed(null):this.store.set({isDrawing:!1});return}if(t===null)return;if(this.isPerspective()&&(e.key===`+`||e.key===`-`)){this.zoom(e.key===`-`?l:1/l);return}if(e.key===`Enter`&&this.drawing.trail!==null){e.preventDefault(),this.finishCurve(this.drawing.setCorner(this.pointed));return}let n=this.isPerspective()?this.currentGaze():{azimuthDeg:180,elevationDeg:45},r=ae(e,this.pointed??n,t);r!==null&&(e.preventDefault(),this.isPerspective()&&!this.canvas.shows(r)&&(this.lookAt({...r,fieldDeg:this.currentGaze().fieldDeg}),this.drawSoon()),this.setPointed(r))}};export{Nt as t};