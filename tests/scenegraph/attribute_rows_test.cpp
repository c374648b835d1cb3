// Rows that are bound to members: their kinds and defaults, and what is read into the desc.
#include "scenegraph/language/attribute_rows.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>

#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

enum class Gait { walk, trot };

struct Legs {
  std::uint32_t count = 4;
  float length_m = 0.55f;

  static AttributeRows<Legs> rows() {
    return {row(&Legs::count, "legs", "", {.min = 1, .max = 8}, "how many"),
            row(&Legs::length_m, "length", "m", kAboveZero, "of each"),
            checked<Legs>([](const Legs& legs, const AttributeValues& a) {
              if (legs.count == 3) fail_at(a.where("legs"), "three legs do not walk");
            })};
  }
};

struct RobotDesc {
  double frequency_hz = 77e9, width_m = 0.1, lean_rad = glm::radians(35.3);
  double resolution_px = 0;  // 0: not given
  glm::dvec3 field_t{0, 2e-5, -4.5e-5};
  Gait gait = Gait::trot;
  bool sees = true, hears = false;
  std::string name = "R2", part = "ROOT";
  std::optional<double> speed_mps{};
  Legs legs{.count = 6};

  static AttributeRows<RobotDesc> rows() {
    using Desc = RobotDesc;
    return {row(&Desc::frequency_hz, "frequency", "Hz", kAnyNumber, "of its clock"),
            row(&Desc::width_m, "width", "m", {.min = 0, .max = 2, .open_min = true}, "from side to side"),
            row(&Desc::lean_rad, "lean", kDegrees, kNotNegative, "to the side"),
            row(&Desc::resolution_px, "resolution", "px", kNotNegative, "of its eyes").without_default(),
            row(&Desc::field_t, "field", "T", kAnyNumber, "around it"),
            row(&Desc::gait, "gait", {{Gait::trot, "trot"}, {Gait::walk, "walk"}}, "how it moves"),
            flags_row<Desc>("senses", {{"eyes", &Desc::sees}, {"ears", &Desc::hears}}, "what it has"),
            row(&Desc::name, AttributeKind::text, "label", "its name"),
            row(&Desc::part, AttributeKind::part, "part", "where it stands"),
            row(&Desc::speed_mps, "speed", "m/s", kNotNegative, "when it runs"),
            nested(&Desc::legs, Legs::rows()),
            AttributeSpec{.name = "rate", .default_value = "3", .text = "read by others"}};
  }
};

RobotDesc read_robot(const std::string& attributes) {
  const std::vector<Command> commands = parse_commands("<sensor type='t' " + attributes + "/>", "s.xml", "");
  constexpr std::string_view kCommon[] = {"type"};
  return rows_of<RobotDesc>().read(AttributeValues(commands.at(0), rows_of<RobotDesc>().table(), kCommon));
}

AttributeSpec spec_of(std::string_view name) {
  const AttributeTable table = rows_of<RobotDesc>().table();
  const auto found = std::ranges::find(table, name, &AttributeSpec::name);
  REQUIRE(found != table.end());
  return *found;
}

}  // namespace

TEST_CASE("kinds and defaults of bound rows come from the members") {
  using Kind = AttributeKind;
  const struct {
    std::string_view name;
    Kind kind;
    std::string_view default_value;
  } expected[] = {{"frequency", Kind::number, "77e9"},
                  {"width", Kind::number, "0.1"},
                  {"lean", Kind::number, "35.3"},
                  {"resolution", Kind::number, ""},
                  {"field", Kind::vector, "0 2e-5 -4.5e-5"},
                  {"gait", Kind::choice, "trot"},
                  {"senses", Kind::flags, "eyes"},
                  {"label", Kind::text, "R2"},
                  {"part", Kind::part, ""},
                  {"speed", Kind::number, ""},
                  {"legs", Kind::integer, "6"},
                  {"length", Kind::number, "0.55"},
                  {"rate", Kind::number, "3"}};
  const AttributeTable table = rows_of<RobotDesc>().table();
  REQUIRE(table.size() == std::size(expected));
  CHECK(check_table(table).empty());
  for (std::size_t i = 0; i < table.size(); ++i) {
    CAPTURE(expected[i].name);
    CHECK(table[i].name == expected[i].name);
    CHECK(table[i].kind == expected[i].kind);
    CHECK(table[i].default_value == expected[i].default_value);
  }
  CHECK(spec_of("gait").choices == "trot walk");
  CHECK(spec_of("senses").choices == "eyes ears");
  CHECK(spec_of("lean").unit == "deg");
  CHECK(spec_of("width").max == 2);
  CHECK(spec_of("width").open_min);
}

TEST_CASE("a desc without attributes is a default-constructed one, to the last bit") {
  const RobotDesc read = read_robot(""), plain;
  CHECK(read.lean_rad == plain.lean_rad);
  CHECK(read.field_t == plain.field_t);
  CHECK(read.gait == plain.gait);
  CHECK(read.sees);
  CHECK_FALSE(read.hears);
  CHECK(read.part == "ROOT");
  CHECK_FALSE(read.speed_mps.has_value());
  CHECK(read.legs.count == 6);
  CHECK(read.legs.length_m == 0.55f);
}

TEST_CASE("written attributes replace the members that they are bound to") {
  const RobotDesc read = read_robot(
      "lean='90' resolution='8' field='1 2 3' gait='walk' senses='ears' label='C3' part='P' speed='2' legs='8' "
      "length='1.5'");
  CHECK(read.lean_rad == glm::radians(90.0));
  CHECK(read.resolution_px == 8);
  CHECK(read.field_t == glm::dvec3(1, 2, 3));
  CHECK(read.gait == Gait::walk);
  CHECK_FALSE(read.sees);
  CHECK(read.hears);
  CHECK(read.name == "C3");
  CHECK(read.part == "P");
  CHECK(read.speed_mps == 2);
  CHECK(read.legs.count == 8);
  CHECK(read.legs.length_m == 1.5f);
}

TEST_CASE("checks of a nested desc name the place of its attribute") {
  CHECK(error_of([] { read_robot("\n legs='3'"); }) == "s.xml:2:2: error: three legs do not walk");
}

TEST_CASE("live rows give their values to the members, in the order of the table") {
  struct Lamp {
    double watts = 60;
    glm::vec3 color{0.9f, 0.05f, 0};
    double turn_rad = 0;
  };
  const AttributeRows<Lamp> rows{row(&Lamp::watts, "power", "W", kNotNegative, "that it takes").live(),
                                 AttributeSpec{.name = "socket", .kind = AttributeKind::text, .text = "E27"},
                                 color_rows(&Lamp::color, "glass_", {.min = 0, .max = 1}, " of its glass"),
                                 row(&Lamp::turn_rad, "turn", kDegrees, kAnyNumber, "about z").live()};
  const AttributeTable table = rows.table();
  REQUIRE(table.size() == 6);
  CHECK(table[2].name == "glass_red");
  CHECK(table[3].text == "green of its glass");
  CHECK(table[3].default_value == "0.05");
  CHECK(table[4].live);
  CHECK_FALSE(table[1].live);
  Lamp lamp;
  rows.set(lamp, std::vector<double>{40, 1, 0.5, 0.25, 90});
  CHECK(lamp.watts == 40);
  CHECK(lamp.color == glm::vec3(1, 0.5f, 0.25f));
  CHECK(lamp.turn_rad == glm::radians(90.0));
}

TEST_CASE("live rows of a nested desc give their values to its members") {
  struct Bulb {
    double watts = 60;
  };
  struct Pair {
    Bulb left{}, right{};
  };
  const auto bulb = [](const char* name) {
    return AttributeRows<Bulb>(row(&Bulb::watts, name, "W", kNotNegative, "that it takes").live());
  };
  const AttributeRows<Pair> rows{nested(&Pair::left, bulb("left")), nested(&Pair::right, bulb("right"))};
  Pair pair;
  rows.set(pair, std::vector<double>{40, 75});
  CHECK(pair.left.watts == 40);
  CHECK(pair.right.watts == 75);
}

TEST_CASE("rows with a condition are for the commands that satisfy it") {
  struct Bulb {
    bool bright = false;
    double watts = 60;
  };
  struct Torch {
    bool lit = false, far = false;
    double range_m = 10, width_deg = 30;
    Bulb bulb{};
  };
  const AttributeWords<bool> words{{false, "no"}, {true, "yes"}};
  const AttributeRows<Bulb> bulb{
      row(&Bulb::bright, "bright", words, "its look"),
      row(&Bulb::watts, "power", "W", kNotNegative, "it takes").live().only("for a bright bulb", &Bulb::bright)};
  const AttributeRows<Torch> rows{
      // The condition of the first row is read after it.
      row(&Torch::range_m, "range", "m", kNotNegative, "it shows").live().only("with light", &Torch::lit),
      row(&Torch::lit, "lit", words, "its state"),
      AttributeRows<Torch>{row(&Torch::far, "far", words, "its aim"),
                           row(&Torch::width_deg, "width", "deg", kAnyNumber, "its cone").live().full_turn()}
          .only("with light", &Torch::lit),
      nested(&Torch::bulb, bulb)};
  const AttributeTable table = rows.table();
  const auto read = [&](const std::string& attributes) {
    const std::vector<Command> commands = parse_commands("<sensor type='t' " + attributes + "/>", "s.xml", "");
    constexpr std::string_view kCommon[] = {"type"};
    return rows.read(commands.at(0), AttributeValues(commands.at(0), table, kCommon));
  };
  const auto live = [&](const Torch& torch) {
    std::vector<AttributeSpec> specs;
    std::ranges::copy_if(table, std::back_inserter(specs), &AttributeSpec::live);
    rows.adapt(torch, specs);
    std::string names;
    for (const AttributeSpec& spec : specs) names += std::string(spec.name) + " ";
    return names;
  };

  CHECK(error_of([&] { read("\n range='3'"); }) == "s.xml:2:2: error: attribute \"range\" is allowed only with light");
  CHECK(error_of([&] { read("far='no'"); }).ends_with("attribute \"far\" is allowed only with light"));
  CHECK(error_of([&] { read("power='3'"); }).ends_with("attribute \"power\" is allowed only for a bright bulb"));
  Torch lit = read("lit='yes' range='3' far='yes'"), bright = read("bright='yes' power='3'"), dark = read("");
  CHECK(lit.range_m == 3);
  CHECK(bright.bulb.watts == 3);
  CHECK(live(lit) == "range width ");
  CHECK(live(bright) == "power ");
  CHECK(live(dark).empty());
  rows.set(lit, std::vector<double>{5, 40});
  rows.set(bright, std::vector<double>{8});
  rows.set(dark, {});
  CHECK(lit.range_m == 5);
  CHECK(lit.width_deg == 40);
  CHECK(bright.bulb.watts == 8);
  CHECK(table[3].full_turn);
}

TEST_CASE("defaults in radians are written in the degrees that give the same bits") {
  for (int tenth = 1; tenth < 3600; ++tenth) {
    const double degrees = tenth / 10.0;
    CAPTURE(degrees);
    const std::string text = rows_detail::written(glm::radians(degrees), kDegrees.factor);
    double number = 0;
    REQUIRE(parse_number(text, number));
    CHECK(glm::radians(number) == glm::radians(degrees));
    CHECK(text.size() <= 5);
  }
}

}  // namespace simvis

TEST_SUITE_END();
