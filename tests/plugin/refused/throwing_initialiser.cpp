// A plug-in whose static initialiser throws.
#include <simvis/element.h>

#include <stdexcept>
#include <vector>

namespace simvis {
namespace {

std::vector<double> read_table() { throw std::runtime_error("no file table.csv"); }

const std::vector<double> kTable = read_table();

}  // namespace
}  // namespace simvis
