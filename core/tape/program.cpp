#include "core/tape/program.hpp"

#include "core/tape/lowered.hpp"

namespace least::tape {

Program::Program(const Tape& tape, std::span<const Index> rates, std::size_t most)
    : Program(lowered(tape, rates, most)) {}

}  // namespace least::tape
