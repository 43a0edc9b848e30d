// Gives the transport the budget of core/memory_budget.hpp, the only part of the core that it uses.
#pragma once

#include "core/memory_budget.hpp"
