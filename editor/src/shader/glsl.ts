/**
 * Moving least squares in a vertex shader, by the core's rule (`crates/core/src/mls`) but in single precision.
 *
 * `R = argmax over SO(3) of tr(R (C / |C| + 1e-9 G^T))`. Where one weight dominates, C is nearly of rank one, and what decides the
 * rotation about its axis lies below the rounding errors of C's entries. So C is never formed in the world's axes: with k the
 * dominant control point and j the one whose product `r_j a_j b_j^T` is largest, C is summed up in one frame whose first axis
 * is a_j (rows) and another whose first axis is b_j (columns). The largest product then has one entry that is not zero, and each
 * of the others keeps all the digits that its own size allows. One-sided Jacobi rotations keep them too (Demmel, Veselic, "Jacobi's
 * method is more accurate than QR", 1992), where an eigenvalue problem would mix entries of all sizes.
 *
 * Affine maps are treated alike: `M = G + E^T (P + 1e-12 |P|)^-1` from the residuals E, with P in a frame along a_j and the
 * largest remaining direction, and Cholesky's method, which is accurate for graded matrices.
 */
export const DEFORM_VERTEX_SHADER = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;

const int RIGID = 0, SIMILARITY = 1, AFFINE = 2;
const int NO_TINT = 0, TINT_BY_WEIGHT = 1, TINT_BY_POINT = 2;
const float ANCHOR_WEIGHT = 1e-9, RIDGE = 1e-12;
// Below this a component is the rounding error of a difference of single-precision places.
const float NOISE = 4e-7;

layout(location = 0) in vec3 x;
layout(location = 1) in vec3 normal;
layout(location = 2) in uint point;

uniform sampler2D logits;         // row by row, a point's logits in successive texels, four in each
uniform sampler2D controlPoints;  // row 0: p, row 1: q, row 2: colours, rows 3 to 5: rotations
uniform int m;
uniform int transform;
uniform float temperature;
uniform bool moved;               // whether any target is not its control point, or turned
uniform bool anyTurned;           // whether any control point carries a rotation
uniform mat3 anchorRotation;
uniform float anchorScale;
uniform mat3 anchorLinear;
uniform int tintBy;
uniform int tinted;               // the control point whose weight is the tint, -1: none

out vec3 y;
out vec3 turned;
out vec3 tint;

vec4 fourLogits(int i) {
  int at = int(point) * ((m + 3) >> 2) + (i >> 2), width = textureSize(logits, 0).x;
  return texelFetch(logits, ivec2(at % width, at / width), 0);
}

vec3 p(int i) { return texelFetch(controlPoints, ivec2(i, 0), 0).xyz; }
vec3 q(int i) { return texelFetch(controlPoints, ivec2(i, 1), 0).xyz; }
// The transpose of the rotation that a control point carries, its scale, and the square of the size of its frame: 0 for none.
mat3 turnOf(int i) {
  vec3 x = texelFetch(controlPoints, ivec2(i, 3), 0).xyz, y = texelFetch(controlPoints, ivec2(i, 4), 0).xyz;
  return mat3(x, y, texelFetch(controlPoints, ivec2(i, 5), 0).xyz);
}
float squareOf(int i) { return texelFetch(controlPoints, ivec2(i, 3), 0).w; }
float scaleOf(int i) { return texelFetch(controlPoints, ivec2(i, 4), 0).w; }

// The weights relative to the second-largest, which stay finite however small the temperature is.
int k;          // the dominant control point
float kLogit;
float second;   // the second-largest weight
float secondLogit;
float first;    // the largest weight

float relative(int i, float logit) { return i == k ? 0.0 : exp((logit - secondLogit) / temperature); }

// Finds k and the second-largest weight.
void findWeights() {
  k = 0;
  kLogit = -3e38;
  secondLogit = -3e38;
  vec4 four;
  for (int i = 0; i < m; i++) {
    if ((i & 3) == 0) four = fourLogits(i);
    float logit = four[i & 3];
    if (logit > kLogit) { secondLogit = kLogit; kLogit = logit; k = i; }
    else if (logit > secondLogit) secondLogit = logit;
  }
  float sum = 0.0;
  for (int i = 0; i < m; i++) {
    if ((i & 3) == 0) four = fourLogits(i);
    sum += relative(i, four[i & 3]);
  }
  float ratio = m < 2 ? 0.0 : exp((secondLogit - kLogit) / temperature);
  second = ratio / (1.0 + ratio * sum);
  first = 1.0 / (1.0 + ratio * sum);
}

// A right-handed frame with the first axis u. Duff et al., "Building an orthonormal basis, revisited", 2017.
mat3 frameAlong(vec3 u) {
  float s = u.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (s + u.z), b = u.x * u.y * a;
  return mat3(u, vec3(1.0 + s * u.x * u.x * a, s * b, -s * u.x), vec3(b, s + u.y * u.y * a, -u.y));
}

vec3 direction(vec3 v, vec3 otherwise) {
  float size = max(max(abs(v.x), abs(v.y)), abs(v.z));
  return size > 0.0 ? normalize(v / size) : otherwise;
}

float size(mat3 c) {
  return sqrt(dot(c[0], c[0]) + dot(c[1], c[1]) + dot(c[2], c[2]));
}

// Turns columns i and j of c, and of w, until those of c are orthogonal.
void turnColumns(inout vec3 ci, inout vec3 cj, inout vec3 wi, inout vec3 wj) {
  float ii = dot(ci, ci), jj = dot(cj, cj), ij = dot(ci, cj);
  if (abs(ij) <= 3e-8 * sqrt(ii) * sqrt(jj)) return;
  float zeta = (jj - ii) / (2.0 * ij);
  float t = (zeta < 0.0 ? -1.0 : 1.0) / (abs(zeta) + (abs(zeta) < 1e10 ? sqrt(1.0 + zeta * zeta) : abs(zeta)));
  float cosine = inversesqrt(1.0 + t * t), sine = cosine * t;
  vec3 oldC = ci, oldW = wi;
  ci = cosine * oldC - sine * cj;
  cj = sine * oldC + cosine * cj;
  wi = cosine * oldW - sine * wj;
  wj = sine * oldW + cosine * wj;
}

// The rotation R that maximises tr(R c): from c = U S W^T, R = W U^T, its third axes such that it is no reflection.
mat3 bestRotation(mat3 c) {
  mat3 w = mat3(1.0);
  for (int sweep = 0; sweep < 6; sweep++) {
    turnColumns(c[0], c[1], w[0], w[1]);
    turnColumns(c[0], c[2], w[0], w[2]);
    turnColumns(c[1], c[2], w[1], w[2]);
  }
  vec3 s = vec3(dot(c[0], c[0]), dot(c[1], c[1]), dot(c[2], c[2]));
  int last = s.z <= s.x && s.z <= s.y ? 2 : s.y <= s.x ? 1 : 0;
  int one = last == 0 ? 1 : 0, two = last == 2 ? 1 : 2;
  if (s[one] < s[two]) { int swap = one; one = two; two = swap; }
  vec3 u1 = direction(c[one], vec3(1.0, 0.0, 0.0));
  vec3 u2 = direction(c[two] - dot(u1, c[two]) * u1, frameAlong(u1)[1]);
  mat3 u = mat3(u1, u2, cross(u1, u2)), v = mat3(w[one], w[two], cross(w[one], w[two]));
  return v * transpose(u);
}

// What a turned control point counts: the square of its weight times that of its frame, over the second-largest weight unless the
// dominant one is turned (crates/core/src/mls/oriented.rs).
float shareOf(int i, float logit) {
  float r = relative(i, logit), w = i == k ? first : second * r;
  return squareOf(i) * w * (squareOf(k) > 0.0 ? w : r);
}

struct Moments {
  vec3 sumA;      // sum of r a
  vec3 sumShift;  // sum of r (b - a)
};

// The components of v along a frame; what lies within rounding errors of its first axis counts as on it.
vec3 along(mat3 f, vec3 v) {
  vec3 c = v * f;
  float noise = NOISE * abs(c.x);
  return vec3(c.x, abs(c.y) > noise ? c.y : 0.0, abs(c.z) > noise ? c.z : 0.0);
}

// Rotation (rigid) or rotation and scale (similarity).
mat3 conformal(vec3 pk, vec3 qk, out Moments moments) {
  vec4 four;
  int j = k;
  float largest = 0.0;
  for (int i = 0; i < m; i++) {
    if ((i & 3) == 0) four = fourLogits(i);
    float product = relative(i, four[i & 3]) * length(p(i) - pk) * length(q(i) - qk);
    if (product > largest) { largest = product; j = i; }
  }
  vec3 aj = p(j) - pk, bj = q(j) - qk;
  mat3 rows = frameAlong(direction(aj, vec3(1.0, 0.0, 0.0))), columns = frameAlong(direction(bj, vec3(1.0, 0.0, 0.0)));
  vec3 sumA = vec3(0.0), sumB = vec3(0.0), sumShift = vec3(0.0);
  float extent = 0.0;
  mat3 c = mat3(0.0);
  for (int i = 0; i < m; i++) {
    if ((i & 3) == 0) four = fourLogits(i);
    float r = relative(i, four[i & 3]);
    vec3 a = p(i) - pk, b = q(i) - qk;
    sumShift += r * (b - a);
    a = i == j ? vec3(length(a), 0.0, 0.0) : a * rows;
    b = i == j ? vec3(length(b), 0.0, 0.0) : b * columns;
    sumA += r * a;
    sumB += r * b;
    extent += r * dot(a, a);
    c += outerProduct(r * a, b);
  }
  c -= outerProduct(second * sumA, sumB);
  extent -= second * dot(sumA, sumA);
  moments = Moments(rows * sumA, sumShift);
  mat3 turns = mat3(0.0);
  float larger = 0.0;
  if (anyTurned) {
    if (squareOf(k) > 0.0) {
      c *= second;
      extent *= second;
    }
    for (int i = 0; i < m; i++) {
      if ((i & 3) == 0) four = fourLogits(i);
      if (squareOf(i) == 0.0) continue;
      float share = shareOf(i, four[i & 3]);
      turns += share * (transpose(rows) * turnOf(i) * columns);
      larger += 3.0 * share * scaleOf(i);
      extent += 3.0 * share;
    }
  }
  mat3 places = c;
  c += turns;
  float norm = size(c);
  mat3 rotation = anchorRotation;
  mat3 local = transpose(columns) * anchorRotation * rows;
  if (norm > 0.0) {
    local = bestRotation(c / norm + ANCHOR_WEIGHT * transpose(local));
    rotation = columns * local * transpose(rows);
  }
  if (transform == RIGID) return rotation;
  mat3 t = transpose(local);
  float scale = (dot(t[0], places[0]) + dot(t[1], places[1]) + dot(t[2], places[2]) + larger) / extent;
  return rotation * (extent > 0.0 ? max(scale, 0.0) : anchorScale);
}

mat3 affine(vec3 pk, vec3 qk, out Moments moments) {
  vec4 four;
  int j = k, l = k;
  float largest = 0.0;
  for (int i = 0; i < m; i++) {
    if ((i & 3) == 0) four = fourLogits(i);
    vec3 a = p(i) - pk;
    float product = relative(i, four[i & 3]) * dot(a, a);
    if (product > largest) { largest = product; j = i; }
  }
  mat3 rows = frameAlong(direction(p(j) - pk, vec3(1.0, 0.0, 0.0)));
  largest = 0.0;
  for (int i = 0; i < m; i++) {
    if ((i & 3) == 0) four = fourLogits(i);
    vec3 a = along(rows, p(i) - pk);
    float product = i == j ? 0.0 : relative(i, four[i & 3]) * dot(a.yz, a.yz);
    if (product > largest) { largest = product; l = i; }
  }
  vec3 v = direction(p(l) - pk - dot(p(l) - pk, rows[0]) * rows[0], rows[1]);
  v = l == k ? rows[1] : normalize(v - dot(v, rows[0]) * rows[0]);
  rows = mat3(rows[0], v, cross(rows[0], v));
  vec3 sumA = vec3(0.0), sumE = vec3(0.0), sumShift = vec3(0.0);
  mat3 pp = mat3(0.0), pe = mat3(0.0);
  for (int i = 0; i < m; i++) {
    if ((i & 3) == 0) four = fourLogits(i);
    float r = relative(i, four[i & 3]);
    vec3 a = p(i) - pk, b = q(i) - qk;
    vec3 e = b - anchorLinear * a;
    sumShift += r * (b - a);
    float far = length(a);
    a = a * rows;
    if (abs(a.y) <= NOISE * far || i == j) a.y = 0.0;
    if (abs(a.z) <= NOISE * far || i == j || i == l) a.z = 0.0;
    sumA += r * a;
    sumE += r * e;
    pp += outerProduct(r * a, a);
    pe += outerProduct(r * a, e);
  }
  pp -= outerProduct(second * sumA, sumA);
  pe -= outerProduct(second * sumA, sumE);
  moments = Moments(rows * sumA, sumShift);
  if (anyTurned) {
    if (squareOf(k) > 0.0) {
      pp *= second;
      pe *= second;
    }
    for (int i = 0; i < m; i++) {
      if ((i & 3) == 0) four = fourLogits(i);
      if (squareOf(i) == 0.0) continue;
      float share = shareOf(i, four[i & 3]);
      pp += mat3(share);
      pe += share * (transpose(rows) * (scaleOf(i) * turnOf(i) - transpose(anchorLinear)));
    }
  }
  float norm = size(pp);
  if (!(norm > 0.0)) return anchorLinear;
  pp = pp / norm + mat3(RIDGE);
  pe /= norm;
  // Cholesky: pp = L L^T. What cancels to nothing leaves the ridge.
  float l00 = sqrt(max(pp[0][0], RIDGE)), l10 = pp[0][1] / l00, l20 = pp[0][2] / l00;
  float l11 = sqrt(max(pp[1][1] - l10 * l10, RIDGE)), l21 = (pp[1][2] - l20 * l10) / l11;
  float l22 = sqrt(max(pp[2][2] - l20 * l20 - l21 * l21, RIDGE));
  mat3 correction;
  for (int d = 0; d < 3; d++) {
    vec3 s = pe[d];
    s.x /= l00;
    s.y = (s.y - l10 * s.x) / l11;
    s.z = (s.z - l20 * s.x - l21 * s.y) / l22;
    s.z /= l22;
    s.y = (s.y - l21 * s.z) / l11;
    s.x = (s.x - l10 * s.y - l20 * s.z) / l00;
    correction[d] = rows * s;
  }
  return anchorLinear + transpose(correction);
}

// Blue over white to red for a weight from 0 to 1; linear, as all colours of vertices are.
vec3 heat(float w) {
  vec3 low = vec3(0.09, 0.17, 0.42), middle = vec3(0.86, 0.87, 0.84), high = vec3(0.86, 0.22, 0.06);
  return pow(w < 0.5 ? mix(low, middle, 2.0 * w) : mix(middle, high, 2.0 * w - 1.0), vec3(2.2));
}

vec3 tintOf() {
  vec4 four;
  vec3 mixed = vec3(0.0);
  float rest = 1.0, own = 0.0;
  for (int i = 0; i < m; i++) {
    if ((i & 3) == 0) four = fourLogits(i);
    float w = second * relative(i, four[i & 3]);
    rest -= w;
    if (i == tinted) own = w;
    mixed += w * texelFetch(controlPoints, ivec2(i, 2), 0).xyz;
  }
  mixed += rest * texelFetch(controlPoints, ivec2(k, 2), 0).xyz;
  if (tintBy == TINT_BY_POINT) return mixed;
  return heat(k == tinted ? rest : own);
}

void main() {
  y = x;
  turned = normal;
  tint = vec3(1.0);
  if (m == 0 || (!moved && tintBy == NO_TINT)) return;
  findWeights();
  if (tintBy != NO_TINT) tint = tintOf();
  if (!moved) return;
  Moments moments;
  vec3 pk = p(k), qk = q(k);
  mat3 map = transform == AFFINE ? affine(pk, qk, moments) : conformal(pk, qk, moments);
  vec3 arm = x - pk - second * moments.sumA;
  y = x + (map * arm - arm) + (qk - pk) + second * moments.sumShift;
  if (transform == AFFINE) {
    mat3 cofactors = mat3(cross(map[1], map[2]), cross(map[2], map[0]), cross(map[0], map[1]));
    // Along the inverse transpose, and on the side of the winding even under a reflection.
    turned = cofactors * normal;
  } else {
    turned = map * normal;
  }
  turned = direction(turned, normal);
}
`;

/** There are no fragments, but a program has to have this. */
export const NO_FRAGMENTS = `#version 300 es
void main() {}
`;
