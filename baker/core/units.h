/// Conventions of the whole project, stated once.
///
/// Lengths    metres, world space, right-handed, Y up (as glTF). Positions are floats relative to Scene::origin (double).
/// Colour     three channels, linear Rec.709. Reflectance 0..1 without unit.
/// Light      photometric per channel, because glTF's units are:
///              M  self-emitted exitance, lm/m2. A surface of L nits (cd/m2) has M = pi * L.
///              B  radiosity, lm/m2: what leaves a surface. B = M + rho * H.
///              H  irradiance, lm/m2 (lux): what arrives. Lightmaps store H; a viewer shows rho / pi * H.
///              point and spot lamps: candela (lm/sr); directional lamps: lux.
/// G_ij       exchange area A_i F_ij = A_j F_ji, m2.
/// Power      lm per channel: area times exitance.
/// Texels     lightmap coordinates in texels, x right, y down (glTF's V points down), texel (x, y) covers [x, x+1) x [y, y+1).
/// Sides      the front of a triangle is the side from which its vertices run counter-clockwise.
/// Bytes      sizes end in _bytes; counts in _count; ids in _id; indexes into an array of things carry the thing's name.
#pragma once

namespace luxel {
constexpr double pi = 3.14159265358979323846;
}
