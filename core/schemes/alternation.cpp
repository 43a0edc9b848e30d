#include "core/schemes/alternation.hpp"

namespace least {

template const Alternation<double>& Alternation<double>::of(const Composition& composition);
template const Alternation<double>& Alternation<double>::named(std::size_t i);

}  // namespace least
