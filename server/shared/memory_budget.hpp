// The budget of core/memory_budget.hpp, for the transport, which sees nothing else of the core.
#pragma once

#include "core/memory_budget.hpp"
