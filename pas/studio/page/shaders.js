// Programs for the graphics card.  A cell of a surface is a convex body with one polynomial; a pixel's ray becomes a
// polynomial in one variable (frustum form: Reimers and Seland 2008), which is written in Bernstein form where the ray
// is in the cell.  Its first zero is isolated by sign variations and bisection, and found by Newton steps that are
// kept in their bracket.
import { place, exponents } from "./algebra.js";

export const PLANES = 8; // at most, of a cell: a box, a clip and a section

export const MODES = ["shaded", "zebra", "mean", "gauss"];
export const PROBE = "probe";

const binomial = (n, k) => { let r = 1; for (let i = 1; i <= k; i++) r = (r * (n - k + i)) / i; return Math.round(r); };

export const BODY_VERTEX = `#version 300 es
in vec3 corner; uniform mat3 inverse; uniform vec4 view; uniform float bend;
void main() { vec3 q = inverse * corner; float w = 1.0 + bend * q.z; gl_Position = vec4((q.xy - w * view.zw) / view.xy, 0.0, w); }`;

// What all programs share: two lights that go with the camera, stripes, and colours by curvature.
export const LOOK = `
vec3 diverging(float x) {
	x = clamp(x, -1.0, 1.0);
	vec3 low = vec3(.13, .40, .67), mid = vec3(.93, .93, .92), high = vec3(.70, .09, .17);
	return x < 0.0 ? mix(mid, low, pow(-x, .8)) : mix(mid, high, pow(x, .8));
}
vec3 lit(vec3 base, vec3 n, vec3 to, float gloss) {
	float f = dot(n, to);
	vec3 side = normalize(to + light);
	float key = max(0.0, dot(n, side)), shine = pow(max(0.0, dot(n, normalize(side + to))), 48.0);
	return base * (.22 + .30 * f + .56 * key) + gloss * shine;
}
vec3 stripes(vec3 n, vec3 base, float f) {
	float s = fract(asin(clamp(dot(n, normalize(vec3(.35, .85, .4))), -1.0, 1.0)) * 6.0);
	return (s < .5 ? mix(base, vec3(1.0), .75) : vec3(.07, .08, .1)) * (.65 + .35 * f);
}`;

const at = (i, j, k) => { const p = place(i, j, k); return `A[${p >> 2}].${"xyzw"[p & 3]}`; }; // a coefficient

function alongRay(n) { // coefficients of the polynomial on the ray through (u, v), lowest first
	const lines = [];
	for (let k = 1; k <= n; k++) lines.push(`float u${k}=${k > 1 ? `u${k - 1}*u` : "u"}, v${k}=${k > 1 ? `v${k - 1}*v` : "v"};`);
	const sum = (m, l) => Array.from({ length: m + 1 }, (_, j) => [at(m - j, j, l), m - j && `u${m - j}`, j && `v${j}`].filter(Boolean).join("*")).join("+");
	lines.push(`p[0]=${sum(n, 0)};`);
	for (let m = n - 1; m >= 0; m--) {
		const d = n - m;
		lines.push(`p[${d}]=bend*p[${d - 1}]+${sum(m, d)};`);
		for (let k = d - 1; k >= 1; k--) lines.push(`p[${k}]+=bend*p[${k - 1}]+${sum(m, k)};`);
		lines.push(`p[0]+=${sum(m, 0)};`);
	}
	return `void along(float u, float v, out float p[N+1]) {\n${lines.join("\n")}\n}`;
}

function bernstein(n) { // from powers of t to Bernstein form on [t, t + h]; it errs least where both are on one side of 0
	const lines = [];
	for (let i = 0; i < n; i++) for (let k = n - 1; k >= i; k--) lines.push(`p[${k}]+=t*p[${k + 1}];`);
	lines.push("float s=1.0;");
	for (let k = 1; k <= n; k++) lines.push(`s*=h; p[${k}]*=s*${(1 / binomial(n, k)).toFixed(12)};`);
	for (let i = 1; i <= n; i++) for (let k = n; k >= i; k--) lines.push(`p[${k}]+=p[${k - 1}];`);
	const swaps = Array.from({ length: (n + 1) >> 1 }, (_, k) => `s=p[${k}]; p[${k}]=p[${n - k}]; p[${n - k}]=s;`).join(" ");
	return `void bernstein(inout float p[N+1], float t, float h) {\n${lines.join("\n")}\n}\nvoid reversed(inout float p[N+1]) { float s; ${swaps} }`;
}

function zeros(n) {
	const casteljau = (to) => { const l = []; for (let i = 1; i <= n; i++) l.push(...to(i)); return l.join(" "); };
	const left = casteljau((i) => Array.from({ length: n - i + 1 }, (_, j) => `p[${n - j}]=mix(p[${n - j - 1}],p[${n - j}],t);`));
	const right = casteljau((i) => Array.from({ length: n - i + 1 }, (_, k) => `p[${k}]=mix(p[${k}],p[${k + 1}],t);`));
	const value = casteljau((i) => [i === n ? "slope=float(N)*(p[1]-p[0]);" : "", ...Array.from({ length: n - i + 1 }, (_, k) => `p[${k}]=mix(p[${k}],p[${k + 1}],t);`)]);
	return `
int variations(float p[N+1]) { int s=0; bool q=p[0]<0.0, r; ${Array.from({ length: n }, (_, k) => `r=p[${k + 1}]<0.0; s+=int(r!=q); q=r;`).join(" ")} return s; }
void left(inout float p[N+1], float t) { ${left} }
void right(inout float p[N+1], float t) { ${right} }
vec2 value(float p[N+1], float t) { float slope=0.0; ${value} return vec2(p[0], slope); }
float bracketed(float p[N+1]) { // one variation: Newton, bisection where a step leaves the bracket or does not halve
	float low=0.0, high=1.0, step=1.0, x=p[0]/(p[0]-p[N]); bool below=p[0]<0.0;
	for (int i=0; i<40; i++) {
		vec2 f=value(p, x);
		if ((f.x<0.0)==below) low=x; else high=x;
		float y=x-f.x/f.y;
		if (!(y>low && y<high) || abs(y-x)>0.5*step) y=0.5*(low+high);
		step=abs(y-x); x=y;
		if (step<1e-7) break;
	}
	return x;
}
float first(float p[N+1], float from) { // the first zero in [from, 1], or 2
	float b[N+1]=p, low=from, high=1.0, x=2.0;
	for (int i=0; i<int(from>0.0); i++) right(b, from);
	int v=variations(b);
	for (int i=0; i<64 && v!=1; i++) {
		if (v==0 || high-low<1e-6) { if (high>=1.0) return 2.0; low=high; high=1.0; b=p; right(b, low); }
		else { left(b, 0.5); high=0.5*(low+high); }
		v=variations(b);
	}
	for (int i=0; i<int(v==1); i++) x=low+(high-low)*bracketed(b);
	return x;
}`;
}

function jet(n, second) { // value, gradient and second derivatives by nested Horner
	const o = [], H = (text) => (second ? text : "");
	for (let l = n; l >= 0; l--) {
		o.push("{ float r=0.,rx=0.,rxx=0.,ry=0.,rxy=0.,ryy=0.;");
		for (let j = n - l; j >= 0; j--) {
			o.push(`{ float s=${at(n - l - j, j, l)},sx=0.,sxx=0.;`);
			for (let i = n - l - j - 1; i >= 0; i--) o.push(`${H("sxx=sxx*X+2.0*sx; ")}sx=sx*X+s; s=s*X+${at(i, j, l)};`);
			o.push(`${H("ryy=ryy*Y+2.0*ry; rxy=rxy*Y+rx; rxx=rxx*Y+sxx; ")}ry=ry*Y+r; r=r*Y+s; rx=rx*Y+sx; }`);
		}
		o.push(`${H("fzz=fzz*Z+2.0*fz; fxz=fxz*Z+fx; fyz=fyz*Z+fy; fxx=fxx*Z+rxx; fxy=fxy*Z+rxy; fyy=fyy*Z+ryy; ")}fz=fz*Z+f; f=f*Z+r; fx=fx*Z+rx; fy=fy*Z+ry; }`);
	}
	return `void jet(vec3 q, out float f, out vec3 g, out mat3 h) { float X=q.x,Y=q.y,Z=q.z;
	float fx=0.,fxx=0.,fy=0.,fxy=0.,fyy=0.,fz=0.,fxz=0.,fyz=0.,fzz=0.; f=0.;
	${o.join("\n")}
	g=vec3(fx,fy,fz); h=mat3(fxx,fxy,fxz, fxy,fyy,fyz, fxz,fyz,fzz); }`;
}

const NUMBERS = `
#define STEPS 16 // of a search
#define LAST 5
#define DONE 6
#define AFTER 1e-3 // where a search goes on, as a share of the ray
#define GRAZING 0.04 // of the squared cosine
#define DOUBT 16.0 // times what a polynomial errs
#define SURE 1e-3 // a step after which none is needed
#define WALL 1e-3 // how far before a wall a zero may be
#define NOISE 4e-7 // what a polynomial errs, over the sum of its absolute terms`;

// The value at a place to about twice the digits: sums and products with their rounding errors (Dekker 1971), nested
// Horner.  "one" is 1, which compilers do not know: they would simplify the errors away.
const PRECISE = `
vec2 sum(float a, float b) { float s=(a+b)*one, v=(s-a)*one; return vec2(s, (a-(s-v)*one)+(b-v)); }
vec2 split(float a) { float c=4097.0*a*one, h=c-(c-a)*one; return vec2(h, a-h); }
vec2 step2(vec2 f, float x, vec2 halves, vec2 c) { // f x + c
	float m=f.x*x*one; vec2 h=split(f.x), s=sum(m, c.x);
	return sum(s.x, s.y+(((h.x*halves.x-m)+h.x*halves.y+h.y*halves.x)+h.y*halves.y)+f.y*x+c.y);
}
float precise(vec3 q) {
	vec2 f=vec2(0.0), X=split(q.x), Y=split(q.y), Z=split(q.z);
	for (int l=N; l>=0; l--) { vec2 r=vec2(0.0);
		for (int j=N-l; j>=0; j--) { vec2 s=vec2(0.0);
			for (int i=N-l-j; i>=0; i--) { int e=i+j+l, k=j+l, a=e*(e+1)*(e+2)/6+k*(k+1)/2+l; s=step2(s, q.x, X, vec2(A[a>>2][a&3], B[a>>2][a&3])); }
			r=step2(r, q.y, Y, s); }
		f=step2(f, q.z, Z, r); }
	return f.x+f.y;
}`;

// Whether a place is beyond a clip: where one of some polynomials, of these low degrees, is positive.
function ended(degrees) {
	const powers = (e) => e.flatMap((times, axis) => Array(times).fill(`q.${"xyz"[axis]}`));
	const value = (n, i) => exponents(n).map((e, p) => [`C${i}[${p >> 2}].${"xyzw"[p & 3]}`, ...powers(e)].join("*")).join("+");
	const held = degrees.map((n, i) => `uniform vec4 C${i}[${Math.ceil(exponents(n).length / 4)}];`).join(" ");
	return `${held}\nbool ended(vec3 q) { return ${degrees.map((n, i) => `${value(n, i)}>0.0`).join(" || ")}; }`;
}

// The first zero on the ray, or none: quickly, while anything moves.  A single pixel where a ray grazes may be wrong.
const quick = (clipped) => `
	float x=2.0;
	if (t1>t0) {
		float p[N+1]; along(uv.x,uv.y,p); bernstein(p,t0,t1-t0);
		int most=variations(p)>0?${clipped ? "N" : 1}:0;
		float from=0.0;
		for (int i=0; i<most; i++) { x=first(p, from); ${clipped ? "if (x>1.0 || !ended(p0+(t0+(t1-t0)*x)*d)) break; from=x+PAST; x=2.0;" : ""} }
	}
	if (x>1.0) discard;
	float t=t0+(t1-t0)*x, e; vec3 g; mat3 h;
	for (int i=0; i<int(x<=1.0); i++) jet(p0+t*d,e,g,h);
	e/=dot(g,d); t-=abs(e)<NEAR?e:0.0; // nested Horner errs less than the Bernstein form of a long ray`;

// The same with care, for pictures at rest.  The ray is gone through in two parts, from the middle of the cell both ways: powers
// of large numbers of both signs cancel.  So that no zero is missed, the polynomial is moved towards zero by more than it
// errs, and at walls to the next cell neither side leaves a zero to the other.
//
// From a place near a zero, a ray that meets the surface at an angle takes one Newton step, one that grazes it several
// with precise values.  One that might as well miss it goes to where it comes nearest, and on from there.
const search = (clipped) => `
	float a[N+1], t=0.0, e, x; vec3 g; mat3 h; int stage=0;
	along(uv.x,uv.y,a);
	for (int part=0; part<2 && stage<DONE; part++) {
		float ta=part==0?t0:max(t0,0.0), tb=part==0?min(t1,0.0):t1;
		if (!(tb>ta)) continue;
		float p[N+1]=a, noise=0.0, far0=max(abs(ta),abs(tb)), low=0.0;
		for (int k=N; k>=0; k--) noise=noise*far0+abs(a[k]);
		noise*=NOISE; bernstein(p, part==0?tb:ta, part==0?ta-tb:tb-ta);
		if (part==0) reversed(p);
		for (int k=1; k<N; k++) p[k]-=p[0]<0.0?-noise:noise;
		if ((door>0 || ta!=t0) && abs(p[0])<noise) p[0]=p[1]<0.0?noise:-noise;
		x=variations(p)>0?0.0:2.0; stage=0;
		for (int i=0; i<STEPS && stage<DONE && x<=1.0; i++) {
			if (stage==0) { x=first(p, low); t=ta+(tb-ta)*x; if (x>1.0) break; }
			vec3 q=p0+t*d; jet(q,e,g,h);
			float slope=dot(g,d), bent=0.5*dot(d,h*d), next=t-0.5*slope/bent;
			if (stage==LAST) stage=DONE; // its gradient and second derivatives are those at the zero
			else if (stage==0) {
				if (slope*slope<DOUBT*abs(bent)*noise && next>t0 && next<t1) { stage=1; low=x; t=next; }
				else if (slope*slope<GRAZING*dot(g,g)*dot(d,d)) stage=2;
				else { e/=slope; t-=abs(e)<NEAR?e:0.0; stage=abs(e)<SURE?LAST:2; }
			} else {
				e=precise(q);
				if (stage==1) {
					float m=(e-0.25*slope*slope/bent)/bent, s=sqrt(max(0.0,-m));
					stage=2; t=next-s<t0?next+s:next-s;
					if (m>0.0 || t>t1) { stage=0; low=2.0*(next-ta)/(tb-ta)-low+AFTER; x=low; }
				} else { t-=clamp(e/slope,-NEAR,NEAR); stage++; }
			}
			if (stage>=DONE && (t<ta-WALL${clipped ? " || ended(p0+t*d)" : ""})) { stage=0; low=max(low,x)+AFTER; x=low; }
		}
	}
	if (stage<DONE) discard;`;

const CURVED = `
	mat3 H=toWorld*h*transpose(toWorld); float l=length(g);
	float mean=(l*l*(H[0][0]+H[1][1]+H[2][2])-dot(g,H*g))/(2.0*l*l*l);
	mat3 adj=mat3(cross(H[1],H[2]),cross(H[2],H[0]),cross(H[0],H[1]));
	float gauss=dot(g,adj*g)/(l*l*l*l);`;

// Lines where the surface passes from one piece to the next; "heights" are those of the cell over its faces.
const SEAMS = `
	float pixel=2.0*deep*length(upwards)/pixels.y;
	for (int k=0; k<4; k++) if (((seams>>k)&1)==1) color.rgb*=mix(.3, 1.0, smoothstep(.5, 1.5, abs(planes[k].w+dot(planes[k].xyz,p0+t*d))*heights[k]/pixel));`;

// Of the surface or of a neighbour (`aside`, which has no colours by curvature), in one of MODES or as PROBE.
// With `fine`, as exactly as single pixels ask for; `clips` are the degrees of clips that end it, others than its planes.
export function bodyFragment(n, mode, aside, fine, clips) {
	const care = fine && !aside;
	const curved = mode === PROBE || (!aside && (mode === "mean" || mode === "gauss"));
	return `#version 300 es
precision highp float; precision highp int;
#define N ${n}
#define NEAR 2e-2
#define PAST 1e-5 // from a zero to where the next one is looked for
${care ? NUMBERS : ""}
uniform vec4 A[${Math.ceil(exponents(n).length / 4)}], B[${Math.ceil(exponents(n).length / 4)}];
uniform float one;
uniform vec4 planes[${PLANES}]; uniform int sides, inner, seams; uniform vec4 heights;
uniform mat3 toWorld; uniform vec4 view; uniform float bend, distance0, near, far, range, number; uniform vec2 pixels, jitter; uniform vec3 ahead, rightwards, upwards, outside, inside, light;
out vec4 color;
${LOOK}
${alongRay(n)}
${bernstein(n)}
${zeros(n)}
${clips.length ? ended(clips) : ""}
${jet(n, curved || care)}
${care ? PRECISE : ""}
void main() {
	vec2 s=(gl_FragCoord.xy+jitter)/pixels*2.0-1.0, uv=s*view.xy+view.zw;
	vec3 p0=vec3(uv,0.0), d=vec3(bend*uv,1.0);
	float t0=-1e9, t1=1e9; int door=0;
	for (int k=0; k<sides; k++) {
		vec4 q=planes[k]; float a=q.w+dot(q.xyz,p0), b=dot(q.xyz,d), t=-a/b;
		if (b>0.0) { if (t>t0) { t0=t; door=(inner>>k)&1; } } else if (b<0.0) t1=min(t1,t); else if (a<0.0) t1=-1e9;
	}
${(care ? search : quick)(clips.length > 0)}
	float deep=distance0+t;
	gl_FragDepth=clamp(far*(deep-near)/(deep*(far-near)),0.0,1.0);
	g=toWorld*g;
	vec3 n=normalize(g), to=-normalize(ahead+s.x*rightwards+s.y*upwards);
${curved ? CURVED : ""}
${mode === PROBE ? "color=vec4(deep,mean,gauss,number); return;" : `
	float f=dot(n,to); vec3 base=f<0.0?inside:outside; vec3 m=f<0.0?-n:n; f=abs(f);
	${mode === "zebra" ? "color=vec4(stripes(n,base,f),1.0);" : curved ? `color=vec4(diverging(${mode}/range)*(.66+.36*f),1.0);` : "color=vec4(lit(base,m,to,.22),1.0);"}
${aside ? "" : SEAMS}`}
}`;
}

const EYE = "uniform mat3 toEye; uniform vec3 eye; uniform vec2 tan0; uniform float near, far; uniform vec2 jitter, pixels;";

export const MESH_VERTEX = `#version 300 es
in vec3 corner, normal, tint, place; in vec2 bent; ${EYE}
out vec3 at, n, c; out vec2 k;
void main() { at=corner+place-eye; vec3 q=toEye*at; n=normal; c=tint; k=bent;
	gl_Position=vec4(q.xy/tan0-q.z*2.0*jitter/pixels, 2.0*far*(q.z-near)/(far-near)-q.z, q.z); }`;

export const meshFragment = (mode) => `#version 300 es
precision highp float; uniform vec3 light; uniform vec4 cut; uniform vec3 eye; uniform float range; in vec3 at, n, c; in vec2 k; out vec4 color;
${LOOK}
void main() { if (dot(cut.xyz,at+eye)+cut.w<0.0) discard;
	vec3 m=normalize(n), to=-normalize(at); float f=dot(m,to); vec3 base=f<0.0?c*.62:c; if (f<0.0) m=-m;
	${mode === "zebra" ? "color=vec4(stripes(normalize(n),base,abs(f)),1.0);" : mode === "shaded" ? "color=vec4(lit(base,m,to,.18),1.0);" : `color=vec4((isnan(k.x)?vec3(.75):diverging(${mode === "gauss" ? "k.y" : "k.x"}/range))*(.66+.36*abs(f)),1.0);`} }`;

export const LINE_VERTEX = `#version 300 es
in vec3 corner; in vec4 tint; ${EYE} uniform float lift; out vec4 c;
void main() { vec3 q=toEye*(corner-eye); c=tint; gl_Position=vec4(q.xy/tan0-q.z*2.0*jitter/pixels, 2.0*far*(q.z-near)/(far-near)-q.z-lift*q.z, q.z); }`;
export const LINE_FRAGMENT = `#version 300 es
precision mediump float; in vec4 c; out vec4 color; void main() { color=c; }`;
