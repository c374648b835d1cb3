// A client of a host whose shared memory another process damages: nothing makes the client read outside of the memory.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <random>

#include "tests/clients/shared_host.h"
#include "tests/support/long_count.h"
#include "tests/support/tested_build.h"

using namespace simvis;
using client::Connection;

TEST_SUITE_BEGIN("clients");

namespace {

/// The whole memory of a host, to be written as the host does.
class WrittenMemory {
 public:
  explicit WrittenMemory(const std::string& name) : file_(open_object(name)) {
    REQUIRE(file_ >= 0);
    simvis_header header{};
    REQUIRE(::pread(file_, &header, sizeof header, 0) == sizeof header);
    size_ = header.total_size;
    void* const mapped = ::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
    REQUIRE(mapped != MAP_FAILED);
    bytes_ = static_cast<unsigned char*>(mapped);
  }
  ~WrittenMemory() {
    ::munmap(bytes_, size_);
    ::close(file_);
  }
  WrittenMemory(const WrittenMemory&) = delete;
  WrittenMemory& operator=(const WrittenMemory&) = delete;

  simvis_header& header() { return *reinterpret_cast<simvis_header*>(bytes_); }
  unsigned char* at(std::uint64_t offset) { return bytes_ + offset; }
  template <typename Entry>
  Entry& entry(const simvis_region& region, std::size_t index = 0) {
    return reinterpret_cast<Entry*>(bytes_ + region.offset)[index];
  }

 private:
  int file_;
  std::uint64_t size_ = 0;
  unsigned char* bytes_ = nullptr;
};

volatile unsigned char last_read = 0;

// The first and the last byte: what lies outside of the memory ends the program.
void touch(const void* bytes, std::size_t size) {
  if (size == 0) return;
  last_read = static_cast<const unsigned char*>(bytes)[0];
  last_read = static_cast<const unsigned char*>(bytes)[size - 1];
}

void touch_text(const Connection& connection, simvis_text text) {
  const char* const bytes = simvis_text_at(connection.get(), text);
  if (bytes != nullptr) touch(bytes, text.size);
}

template <typename Number>
std::size_t touch_numbers(const client::Measurement& measurement, const char* name) {
  const std::span<const Number> numbers = measurement.output<Number>(name);
  touch(numbers.data(), numbers.size_bytes());
  return numbers.size();
}

/// Reads everything that the library gives; returns how much of it there was.
std::size_t read_all(const Connection& connection) {
  simvis_client* const client = connection.get();
  std::size_t there = 0;
  simvis_find_element(client, "P1");
  simvis_find_parameter(client, "P1", "z");
  const std::int64_t sensor = simvis_find_sensor(client, "S");
  for (std::int64_t id = 0; id < 4; ++id) {
    if (const simvis_element* const element = simvis_element_at(client, id)) {
      touch_text(connection, element->name);
      touch_text(connection, element->insertion_point);
      ++there;
    }
    if (const simvis_parameter* const parameter = simvis_parameter_at(client, id))
      touch_text(connection, parameter->unit);
    simvis_get(client, id);
  }
  if (const auto measurement = sensor < 0 ? std::nullopt : connection.latest(sensor)) {
    there += touch_numbers<float>(*measurement, "range_m") + touch_numbers<double>(*measurement, "range_m") +
             touch_numbers<std::uint8_t>(*measurement, "range_m");
    const simvis_view view = measurement->view();
    const simvis_output* output = nullptr;
    if (const void* const data = simvis_output_data(&view, "range_m", &output)) touch(data, 1);
  }
  std::uint64_t position = 0;
  for (int entries = 0; entries < 8; ++entries) {
    const auto entry = connection.next_log(position);
    if (!entry) break;
    touch(entry->text.data(), entry->text.size());
    ++there;
  }
  std::array<double, 3 * kPoseValues> values{};
  simvis_applied(client, 0, values.data(), values.size());
  return there;
}

struct ServedScene {
  std::string name;
  SharedHost host;
  explicit ServedScene(const std::string& test) : name(unique_name(test)), host(name) {
    host.publish();
    for (int i = 0; i < 3; ++i) add_pose(host, "P" + std::to_string(i));
    host.log(SIMVIS_CHANGE, "<part/>");
    publish_scan(host, host.add_sensor("S", "laser_scanner"), 0, 1);
    host.finish_frame(1, 0);
  }
};

}  // namespace

TEST_CASE("a table, a text or an output that the memory does not hold is not there") {
  ServedScene scene("damaged-host");
  const Connection connection(scene.name, "reader");
  WrittenMemory memory(scene.name);
  const simvis_header whole = memory.header();
  REQUIRE(read_all(connection) > 361);

  SUBCASE("regions are those of the time of the connection") {
    memory.header().strings.offset = memory.header().elements.offset = UINT64_MAX / 2;
    memory.header().elements.count = UINT64_MAX;
    CHECK(connection.element("P1") == 1);
    CHECK(simvis_element_at(connection.get(), static_cast<std::int64_t>(whole.elements.capacity)) == nullptr);
    CHECK_THROWS(Connection(scene.name, "late"));
  }
  SUBCASE("regions that do not lie on numbers, or leave no room") {
    memory.header().values.offset += 1;
    CHECK_THROWS(Connection(scene.name, "late"));
    memory.header() = whole;
    memory.header().clients_offset = whole.total_size - 8;
    CHECK_THROWS(Connection(scene.name, "late"));
  }
  SUBCASE("a text") {
    auto& element = memory.entry<simvis_element>(whole.elements, 1);
    element.name.size = whole.total_size;
    CHECK(simvis_text_at(connection.get(), element.name) == nullptr);
    CHECK(simvis_find_element(connection.get(), "P1") < 0);
    CHECK(simvis_find_element(connection.get(), "P2") == 2);
  }
  SUBCASE("an output") {
    const auto measurement = connection.latest(0);
    REQUIRE(measurement);
    const simvis_view view = measurement->view();
    auto& slot = *const_cast<simvis_slot*>(view.slot);
    auto& output = *reinterpret_cast<simvis_output*>(memory.at(
        static_cast<std::uint64_t>(memory.entry<simvis_sensor>(whole.sensors).slots_offset) + sizeof(simvis_slot)));
    REQUIRE(slot.output_count == 1);
    const simvis_output intact = output;
    const auto is_refused = [&] {
      simvis_output copy{};
      const bool refused = simvis_copy_output(&view, 0, &copy) != 0 && measurement->output<float>("range_m").empty() &&
                           simvis_output_data(&view, "range_m", nullptr) == nullptr;
      output = intact;
      return refused;
    };
    CHECK_FALSE(is_refused());
    output.columns = 1 << 20;
    CHECK(is_refused());
    output.rows = output.columns = output.channels = UINT32_MAX;  // their product does not fit in 64 bits
    CHECK(is_refused());
    output.offset = view.slot_size - 4;
    CHECK(is_refused());
    output.offset = UINT64_MAX - 63;
    CHECK(is_refused());
    output.type = 99;
    CHECK(is_refused());
    output.name_size = UINT32_MAX;
    CHECK(is_refused());
    output.unit_offset = UINT32_MAX;
    CHECK(is_refused());
  }
  SUBCASE("an entry of the log") {
    auto& entry = memory.entry<simvis_log_entry>(whole.log);
    std::uint64_t position = 0;
    entry.text_size = 1;
    for (const std::uint32_t size : {0u, 8u, 33u, UINT32_MAX}) {
      entry.size = size;
      CHECK_FALSE(connection.next_log(position));
    }
    CHECK(position == 0);
  }
}

TEST_CASE("a sensor that is written all the time is told from one that has not measured") {
  const std::string name = unique_name("torn");
  SharedHost host(name);
  host.publish();
  const std::size_t sensor = host.add_sensor("SCAN", "laser_scanner");
  const Connection connection(name, "reader");
  simvis_view view;
  CHECK(simvis_latest(connection.get(), 0, &view) == -1);
  CHECK(simvis_client_error() == std::string("the sensor has not measured yet"));
  publish_scan(host, sensor, 0, 1);
  CHECK(simvis_latest(connection.get(), 0, &view) == 0);
  WrittenMemory memory(name);
  const auto& shared = memory.entry<simvis_sensor>(memory.header().sensors);
  auto& slot = *reinterpret_cast<simvis_slot*>(memory.at(shared.slots_offset));
  ++slot.sequence;  // odd: the host is writing
  CHECK(simvis_latest(connection.get(), 0, &view) == -1);
  CHECK(simvis_client_error() == std::string("the host writes faster than this program reads"));
}

TEST_CASE("every byte that a host writes can be damaged: a client reads nothing outside of the memory") {
  ServedScene scene("damaged-bytes");
  const Connection connection(scene.name, "reader");
  WrittenMemory memory(scene.name);
  const simvis_header whole = memory.header();
  struct Range {
    std::uint64_t offset, bytes;
  };
  const Range ranges[] = {{0, sizeof(simvis_header)},     {whole.elements.offset, 256}, {whole.parameters.offset, 256},
                          {whole.strings.offset, 64},     {whole.log.offset, 512},      {whole.sensors.offset, 64},
                          {whole.outputs.offset, 4 * 256}};
  std::vector<std::vector<unsigned char>> kept;
  for (const Range& range : ranges) kept.emplace_back(memory.at(range.offset), memory.at(range.offset) + range.bytes);
  std::mt19937_64 random(static_cast<std::uint64_t>(count_of("SIMVIS_TEST_SEED", 5)));
  const int damages = count_of("SIMVIS_TEST_DAMAGES", sanitized() ? 4'000 : 20'000);
  std::size_t there = 0;
  for (int i = 0; i < damages; ++i) {
    for (int words = 0; words < 1 + static_cast<int>(random() % 3); ++words) {
      const Range& range = ranges[random() % std::size(ranges)];
      const std::uint64_t word = random() % 4 == 0 ? random() % 300 : random() >> random() % 64;
      const std::size_t bytes = random() % 2 == 0 ? 1 : 8;
      const std::uint64_t at = random() % (range.bytes / bytes) * bytes;
      std::memcpy(memory.at(range.offset + at), &word, bytes);
    }
    // Counts are checked above; here they would make each search touch all of the tables.
    for (simvis_region* region : {&memory.header().elements, &memory.header().parameters, &memory.header().sensors}) {
      region->count = std::min<std::uint64_t>(region->count, 100);
    }
    there += read_all(connection);
    try {
      const Connection late(scene.name, "late");
      there += read_all(late);
    } catch (const client::Error&) {  // it is no memory of a simulation any more
    }
    for (std::size_t each = 0; each < std::size(ranges); ++each) {
      std::memcpy(memory.at(ranges[each].offset), kept[each].data(), kept[each].size());
    }
  }
  CHECK(there > static_cast<std::size_t>(damages));
}

TEST_SUITE_END();
