#include "core/tape/tape.hpp"

namespace least::tape {

Index Tape::insert_at_run(const Node& node) { return insert(node); }

}  // namespace least::tape
