#pragma once

namespace forcebound::server {

/// From now on MuJoCo, in the whole process, finds no contact of two boxes that is deeper than they overlap along its
/// normal.
///
/// In MuJoCo 2.2.2 (and up to 3.11) boxes that lie face to face, tilted by next to nothing, now and then have a phantom
/// among their contacts: a point beside them, as deep as a box is wide. In that one step it throws a stack apart. No
/// point of a box can be deeper in another, along a direction n, than both reach towards each other,
///
///     r1 + r2 - |n . (c2 - c1)|,      r = sum over axes a_i of |n . a_i| s_i
///
/// with centres c, half sizes s and axes a, so that what is deeper is no contact and is left out. All others stay as
/// they are, to the bit. A second call does nothing; not thread-safe.
void leave_out_phantom_contacts() noexcept;

}  // namespace forcebound::server
