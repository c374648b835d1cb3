// CDR: bytes derived by hand from its rules, every type there and back, and bytes that are no message.
#include "exchange/messages/cdr.h"

#include <doctest/doctest.h>

#include <simvis/error.h>
#include "tests/messages/message_values.h"
#include "tests/support/error_of.h"
#include "tests/support/long_count.h"

TEST_SUITE_BEGIN("messages");

namespace simvis::ros {
namespace {

std::string bytes_of(std::initializer_list<int> codes) {
  std::string bytes;
  for (const int code : codes) bytes += static_cast<char>(code);
  return bytes;
}

TEST_CASE("the bytes of small messages follow from the rules") {
  // 8 bytes each for int32 and uint32, little-endian.
  CHECK(encode(Clock{{1, 2}}) == bytes_of({0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0}));
  // A text has its final zero and counts it.
  CHECK(encode(Header{{-1, 3}, "ab"}) ==
        bytes_of({0, 1, 0, 0, 255, 255, 255, 255, 3, 0, 0, 0, 3, 0, 0, 0, 'a', 'b', 0}));
  CHECK(encode(Float64{1}) == bytes_of({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f}));
  // level is one byte, so the length of the name that follows lies at 4.
  CHECK(encode(DiagnosticStatus{std::byte{2}, "", "", "", {}}) ==
        bytes_of({0, 1, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0,
                  0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  // The double behind one byte and one bool lies at 16, behind the int64 at 8: counted from the end of the
  // encapsulation.
  ParameterValue value;
  value.type = 3;
  value.bool_value = true;
  value.integer_value = -2;
  value.double_value = 2;
  value.double_array_value = {4};
  CHECK(encode(value) ==
        bytes_of(
            {0,    1,   0,   0,                                           // encapsulation
             3,    1,   0,   0,   0,   0,   0,   0,                       // type, bool_value, padding to 8
             0xfe, 255, 255, 255, 255, 255, 255, 255,                     // integer_value at 8
             0,    0,   0,   0,   0,   0,   0,   0x40,                    // double_value at 16
             1,    0,   0,   0,   0,   0,   0,   0,                       // string_value at 24, padding to 32
             0,    0,   0,   0,   0,   0,   0,   0,    0, 0, 0,    0,     // no bytes, truth values, integers: 32 to 44
             1,    0,   0,   0,   0,   0,   0,   0,    0, 0, 0x10, 0x40,  // one double: its count at 44, itself at 48
             0,    0,   0,   0}));                                        // no texts
}

TEST_CASE("every type comes back as it was") {
  test::Random random(1);
  for (int i = 0; i < 100; ++i) {
    test::for_each_message([&]<typename M>() {
      M message;
      test::fill(message, random);
      const std::string bytes = encode(message);
      const M back = decode<M>(bytes);
      INFO(M::kName);
      CHECK(test::to_json(back) == test::to_json(message));
      CHECK(encode(back) == bytes);
      CHECK(test::to_json(decode<M>(bytes + std::string(3, '\0'))) == test::to_json(message));
    });
  }
}

TEST_CASE("bytes that are no message are refused with their place") {
  const std::string good = encode(Header{{1, 2}, "map"});
  const auto error = [](const std::string& bytes) { return error_of([&] { decode<Header>(bytes); }); };
  CHECK(error("") == "message std_msgs/msg/Header, byte 0: has no encapsulation");
  CHECK(error(bytes_of({0, 0}) + good.substr(2)).find("expected little-endian CDR") != std::string::npos);
  CHECK(error(good.substr(0, 9)) == "message std_msgs/msg/Header, byte 4: needs 4 bytes, but 1 are left");
  CHECK(error(good.substr(0, 17)) == "message std_msgs/msg/Header, byte 12: needs 4 bytes, but 1 are left");
  CHECK(error(good.substr(0, 19) + "x") == "message std_msgs/msg/Header, byte 16: a text does not end with zero");
  CHECK(error(good + std::string(4, 'x')).find("4 bytes are left behind the last field") != std::string::npos);
  CHECK(decode<Header>(bytes_of({0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0})).frame_id.empty());
  std::string truth = encode(RegionOfInterest{1, 2, 3, 4, true});
  truth.back() = 2;
  CHECK(error_of([&] { decode<RegionOfInterest>(truth); }).find("neither 0 nor 1") != std::string::npos);
  // A count that the rest cannot hold is refused before anything is allocated for it.
  const std::string many = bytes_of({0, 1, 0, 0, 255, 255, 255, 255});
  CHECK(error_of([&] { decode<TFMessage>(many); }).find("needs 4294967295 bytes, but 0 are left") != std::string::npos);
}

/// Decodes the bytes; false if they are refused. What is taken is what it says when it is written again.
template <typename M>
bool takes(const std::string& bytes) {
  M message;
  try {
    message = decode<M>(bytes);
  } catch (const InputError&) {
    return false;
  }
  const std::string again = encode(message);
  return encode(decode<M>(again)) == again;
}

TEST_CASE("damaged bytes are refused or taken, and nothing else happens") {
  test::Random random(2);
  int taken = 0, refused = 0;
  for (int i = count_of("SIMVIS_TEST_DAMAGES", 300); i > 0; --i) {
    test::for_each_message([&]<typename M>() {
      M message;
      test::fill(message, random);
      std::string bytes = encode(message);
      for (std::uint32_t damages = 1 + random() % 4; damages > 0; --damages) {
        bytes[random() % bytes.size()] = static_cast<char>(random());
      }
      if (random() % 4 == 0) bytes.resize(random() % (bytes.size() + 8));
      ++(takes<M>(bytes) ? taken : refused);
    });
  }
  CHECK(taken > 100);
  CHECK(refused > 100);
}

}  // namespace
}  // namespace simvis::ros

TEST_SUITE_END();
