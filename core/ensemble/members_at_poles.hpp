// Members whose damping becomes infinite on their way: lanes do not look for that, so such members run one by one.
#pragma once

#include "core/ensemble/ensemble.hpp"

namespace least {

/// any_meets_pole returns whether the damping α(t) of any member of the block has a pole (core/run/damping_pole.hpp)
/// before its end. Members are looked at one by one only if what varies between them enters α.
bool any_meets_pole(const EnsemblePlan& plan, const Block& block);

}  // namespace least
