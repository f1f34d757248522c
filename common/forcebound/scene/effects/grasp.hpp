#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// Holds the device where it was when its button was pressed, until it is let go: a GuideSpring about the point g,
///
///     o = x - g,    w = v,    g = x on the first motion with the button pressed
///
/// so that the force is zero at first. In an object it holds within it alone: what leaves the object has let go, and
/// what enters it with the button pressed holds where it enters. Letting go gives nothing back: what the spring has
/// stored is lost. A device without that button feels nothing.
///
/// Parameters: `button` k, from 0 (default 0), and those of GuideSpring.
EffectKind grasp_effect();

}  // namespace forcebound::scene
