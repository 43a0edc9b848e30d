// Programs of tapes, whose making counts against the thread's memory budget.
#pragma once

#include <span>

#include "core/memory_budget.hpp"
#include "core/tape/program.hpp"

namespace least::taylor {

/// Returns the program of a tape. The memory for making it is held from the thread's budget meanwhile.
inline tape::Program program_of(const tape::Tape& tape, std::span<const tape::Index> rates, std::size_t most) {
  constexpr std::size_t bytes_of_operation = 320;
  const Held held = HeldByThread::take_soon(bytes_of_operation * static_cast<std::size_t>(tape.size()));
  return {tape, rates, most};
}

}  // namespace least::taylor
