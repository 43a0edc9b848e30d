#include "core/tape/symbol.hpp"

namespace least::recording {

Symbol add(const Symbol& a, const Symbol& b) { return Recorder::add(a, b); }
Symbol subtract(const Symbol& a, const Symbol& b) { return Recorder::subtract(a, b); }
Symbol multiply(const Symbol& a, const Symbol& b) { return Recorder::multiply(a, b); }
Symbol divide(const Symbol& a, const Symbol& b) { return Recorder::divide(a, b); }
Symbol power_of(const Symbol& x, double exponent) { return Recorder::power_of(x, exponent); }

}  // namespace least::recording
