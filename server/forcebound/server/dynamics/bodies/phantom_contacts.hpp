#pragma once

namespace forcebound::server {

/// Makes MuJoCo, in the whole process, drop contacts of two boxes that are deeper than the boxes overlap along the
/// contact's normal.
///
/// In MuJoCo 2.2.2 (and up to 3.11) boxes that lie face to face with a minute tilt occasionally get a phantom contact:
/// a point beside them, as deep as a box is wide. In that one step it throws a stack apart. No point of a box can be
/// deeper in another, along a direction n, than both reach towards each other,
///
///     r1 + r2 - |n . (c2 - c1)|,      r = sum over axes a_i of |n . a_i| s_i
///
/// with centres c, half sizes s and axes a, so deeper contacts are dropped. All others stay as they are, to the bit. A
/// second call does nothing; not thread-safe.
void leave_out_phantom_contacts() noexcept;

}  // namespace forcebound::server
