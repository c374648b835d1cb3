// Outputs as messages: what a stranger sends that does not fit together is no output.
#include "simvis/sharing/output_message.h"

#include <doctest/doctest.h>

#include <limits>

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

ros::Output sent() {
  return to_message(
      {{.name = "offset_mm", .kind = OutputKind::image, .value_type = ValueType::i32, .shape = {2, 3, 1}, .unit = "mm"},
       SharedArray<std::int32_t>{-5, 1, 2, 3, 4, 2'000'000'001}});
}

TEST_CASE("an output arrives as it was sent; of a column of a table only its own numbers") {
  const std::optional<MeasuredArray> array = to_array(sent());
  REQUIRE(array);
  CHECK(array->numbers == MeasuredNumbers(SharedArray<std::int32_t>{-5, 1, 2, 3, 4, 2'000'000'001}));
  const ros::Output column = to_message(
      {{.name = "b", .kind = OutputKind::table_column, .shape = {2, 1, 1}}, SharedArray<double>{1, 2, 3, 4}, 1, 2});
  CHECK(to_array(column)->numbers == MeasuredNumbers(SharedArray<double>{2, 4}));
}

TEST_CASE("outputs that do not fit together are refused") {
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  const auto refused = [](const auto& damage) {
    ros::Output output = sent();
    damage(output);
    return !to_array(output).has_value();
  };
  CHECK(refused([](ros::Output& output) { output.kind = "picture"; }));
  CHECK(refused([](ros::Output& output) { output.type = "f16"; }));
  CHECK(refused([](ros::Output& output) { output.type = "i64"; }));
  CHECK(refused([](ros::Output& output) { output.data.pop_back(); }));
  CHECK(refused([](ros::Output& output) { output.data.insert(output.data.end(), 4, 0); }));
  CHECK(refused([](ros::Output& output) { output.channels = 0; }));
  CHECK(refused([](ros::Output& output) { output.rows = output.columns = output.channels = kMost; }));
  CHECK(refused([](ros::Output& output) { output.rows = output.columns = 1U << 31; }));
  CHECK(refused([](ros::Output& output) { output.data.clear(); }));
  CHECK(refused([](ros::Output& output) {  // 2^32 * 2^32
    output.rows = output.columns = output.channels = 1U << 22;
    output.data.clear();
  }));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
