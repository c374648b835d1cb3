// A plug-in whose static initialiser ends the process.
#include <cstdlib>

namespace {

[[maybe_unused]] const int kNothing = (std::abort(), 0);

}  // namespace
