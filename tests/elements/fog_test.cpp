// The element fog: the medium for its parameters, and the measurements and costs of scanners with and without it.
#include <algorithm>

#include "elements/fog.h"
#include "tests/support/element_scene.h"
#include "tests/support/scan_frame.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

// A few roundings of double.
constexpr double kRounding = 16 * 0x1p-53;

std::string fog(const std::string& attributes, const std::string& name = "FOG") {
  return "<element type='fog' name='" + name + "' insert_at='ROOT' " + attributes + "/>";
}

const Medium& medium_of(World& world) {
  world->step();
  return world->diagnostics().draw_list().medium;
}

void check(double seen, double expected, double relative = kRounding) {
  CAPTURE(seen);
  CAPTURE(expected);
  CHECK(std::abs(seen - expected) <= relative * expected);
}

TEST_CASE("visibility is the distance at which contrast falls to 0.02; lasers see farther by Kim's exponent") {
  World world({}, fog("kind='fog' visibility='1500'"));
  // Exponents computed by hand: v in km, 0.16 v + 0.34 from 1 to 6, v - 0.5 from 0.5 to 1.
  struct Case {
    double visibility_m, exponent;
  };
  const Case cases[] = {{60000, 1.6}, {7000, 1.3}, {2000, 0.66}, {1500, 0.58},
                        {1000, 0.5},  {750, 0.25}, {500, 0},     {20, 0}};
  for (const Case& each : cases) {
    const double visibility_m = each.visibility_m;
    CAPTURE(visibility_m);
    world->set("FOG", "visibility", visibility_m);
    const Medium& medium = medium_of(world);
    CHECK(std::abs(std::exp(-medium.extinction_per_m * visibility_m) - 0.02) <= 16 * 0x1p-53);
    check(medium.laser_extinction_per_m, medium.extinction_per_m * std::pow(905.0 / 550.0, -each.exponent));
    check(medium.backscatter_per_m_sr, medium.laser_extinction_per_m / 18.8);
    CHECK(medium.particles_per_m3 == 0);
  }
}

TEST_CASE("haze and dust have their own lidar ratios; dust is coarse") {
  World haze({}, fog("kind='haze' visibility='3000'")), dust({}, fog("kind='dust' visibility='3000'"));
  const Medium of_haze = medium_of(haze), of_dust = medium_of(dust);
  check(of_haze.laser_extinction_per_m, of_haze.extinction_per_m * std::pow(905.0 / 550.0, -0.82));
  check(of_haze.backscatter_per_m_sr, of_haze.laser_extinction_per_m / 53);
  CHECK(of_dust.laser_extinction_per_m == of_dust.extinction_per_m);
  check(of_dust.backscatter_per_m_sr, of_dust.extinction_per_m / 69);
}

TEST_CASE("rain: the drops of Marshall and Palmer, each with twice its cross-section") {
  World world({}, fog("kind='rain'"));
  for (const double rate_mm_per_h : {0.5, 10.0, 50.0}) {
    CAPTURE(rate_mm_per_h);
    world->set("FOG", "rain_rate", rate_mm_per_h);
    const Medium& rain = medium_of(world);
    // Sums over diameters in steps of 10 micrometres up to 4 cm. The midpoint rule leaves less than 1e-3.
    constexpr double kSum = 1e-3, kStep_mm = 0.01;
    const double slope_per_mm = 4.1 * std::pow(rate_mm_per_h, -0.21);
    double drops = 0, diameters_mm = 0, extinction = 0, discs = 0;
    for (double d = kStep_mm / 2; d < 40; d += kStep_mm) {
      const double count = 8000 * std::exp(-slope_per_mm * d) * kStep_mm;
      drops += count;
      diameters_mm += count * d;
      extinction += count * 2 * std::numbers::pi / 4 * d * d * 1e-6;
      discs += count * 0.024 * d * d / 4 * 1e-6;  // a matte disc returns p / pi of its area's light to each steradian
    }
    check(rain.particles_per_m3, drops, kSum);
    check(rain.particle_diameter_m, diameters_mm / drops * 1e-3, kSum);
    check(rain.laser_extinction_per_m, extinction, kSum);
    CHECK(rain.extinction_per_m == rain.laser_extinction_per_m);
    check(rain.backscatter_per_m_sr, discs, kSum);
    // Measurements over paths of a kilometre, 1.076 rate^0.67 dB/km (Carbonneau and Wisely, Proc. SPIE 3532, 1998), lie
    // between once and twice the cross-section, because the receiver gets a part of the forward-scattered light.
    const double measured = 1.076 * std::pow(rate_mm_per_h, 0.67) * std::log(10.0) / 10 / 1000;
    CHECK(measured <= extinction);
    CHECK(measured >= extinction / 2);
  }
}

TEST_CASE("the power of a drop's echo follows geometric optics") {
  const double n = 1.33, face = std::pow((n - 1) / (n + 1), 2);
  const double of_mirror = face + face * std::pow(1 - face, 2) * std::pow(n / (2 - n), 2);
  CHECK(std::abs(kDropReflectance - of_mirror / 4) <= 0.5e-4);  // its last digit
}

TEST_CASE("snow: the flakes of Sekhon and Srivastava, by quadrature over their melted diameters to 1e-6") {
  World world({}, fog("kind='snow'"));
  for (const double rate_mm_per_h : {0.1, 1.0, 5.0}) {
    CAPTURE(rate_mm_per_h);
    world->set("FOG", "snow_rate", rate_mm_per_h);
    const Medium& snow = medium_of(world);
    constexpr double kQuadrature = 1e-6;
    const double slope_per_mm = 2.29 * std::pow(rate_mm_per_h, -0.45),
                 per_m3_mm = 2500 * std::pow(rate_mm_per_h, -0.94);
    double flakes = 0, extinction = 0, discs = 0;
    // Simpson's rule up to 40 mean diameters, where less than 1e-14 is left.
    constexpr int kSteps = 4000;
    const double step_mm = 40 / slope_per_mm / kSteps;
    for (int i = 0; i <= kSteps; ++i) {
      const double melted_mm = i * step_mm, weight = i == 0 || i == kSteps ? 1 : i % 2 == 0 ? 2 : 4;
      const double count = per_m3_mm * std::exp(-slope_per_mm * melted_mm) * weight * step_mm / 3;
      const double mass_mg = std::numbers::pi / 6 * std::pow(melted_mm, 3);
      const double area_m2 = std::pow(mass_mg / 0.012, 2.0 / 3) * 1e-6;
      flakes += count;
      extinction += 2 * count * area_m2;
      discs += count * area_m2 * (2 * std::numbers::pi / 25) / std::numbers::pi;
    }
    // kFlakeOverMelted has five digits.
    constexpr double kRounded = 2 * 0.5e-4 / 3.9725;
    check(snow.particles_per_m3, flakes, kQuadrature);
    check(snow.laser_extinction_per_m, extinction, kQuadrature + kRounded);
    check(snow.backscatter_per_m_sr, discs, kQuadrature + kRounded);
    CHECK(snow.extinction_per_m == snow.laser_extinction_per_m);
  }
  world->set("FOG", "snow_rate", 0);
  CHECK(medium_of(world) == Medium{});
}

TEST_CASE("dust with grains has the extinction and the backscatter of dust without, and as many grains as give them") {
  World world({}, fog("kind='dust' visibility='50'"));
  const Medium fine = medium_of(world);
  CHECK(fine.particles_per_m3 == 0);
  world->set("FOG", "grain_diameter", 2e-4);
  const Medium& grains = medium_of(world);
  CHECK(grains.laser_extinction_per_m == fine.laser_extinction_per_m);
  CHECK(grains.backscatter_per_m_sr == fine.backscatter_per_m_sr);
  CHECK(grains.particle_diameter_m == 2e-4);
  // Each removes twice its cross-section, whose mean is pi / 4 x 2 D0^2.
  check(grains.particles_per_m3 * 2 * std::numbers::pi / 4 * 2 * 4e-8, fine.laser_extinction_per_m);
}

TEST_CASE("clear air equals a scene without fog; the last of several elements counts; the airlight has a colour") {
  World world({}, fog("kind='rain' rain_rate='0' airlight_red='5'", "A"));
  CHECK(medium_of(world) == Medium{});
  world->execute(fog("airlight_red='0.1' airlight_green='0.2' airlight_blue='0.3' visibility='100'", "B"));
  const Medium& medium = medium_of(world);
  CHECK(medium.airlight == glm::vec3(0.1f, 0.2f, 0.3f));
  world->set("A", "rain_rate", 10);
  CHECK(medium_of(world).particles_per_m3 == 0);
  world->set("B", "airlight_red", 0.4);
  CHECK(medium_of(world).airlight.r == 0.4f);
}

TEST_CASE("mistakes name their place") {
  const auto error = [](const std::string& command) { return error_of([&] { World world({}, command); }); };
  CHECK(contains(error(fog("kind='rain' visibility='20'")),
                 "s.xml:1:61: error: attribute \"visibility\" is allowed only for haze, fog and dust"));
  CHECK(contains(error(fog("rain_rate='20'")), "attribute \"rain_rate\" is allowed only for rain"));
  CHECK(contains(error(fog("visibility='0'")),
                 "\"visibility\": 0 is not allowed, expected a number from 1 to 1000000 (m)"));
  CHECK(contains(error(fog("kind='hail'")), "\"hail\""));
  CHECK(contains(error(fog("kind='snow' rain_rate='1'")), "attribute \"rain_rate\" is allowed only for rain"));
  CHECK(contains(error(fog("kind='haze' grain_diameter='1e-4'")), "is allowed only for dust"));
  const std::string scanner = "<sensor type='laser_scanner' name='S' insert_at='ROOT' ";
  CHECK(contains(error(scanner + "least_power='0'/>"), "\"least_power\": 0 is not allowed"));
  CHECK(contains(error(scanner + "path_depth='17'/>"), "\"path_depth\": 17 is not allowed"));
}

GltfBuilder wall() {
  GltfBuilder file;
  add_plate(file, {}, file.append("materials", painted("White", glm::vec4(1))));
  return file;
}
const std::string kWall = R"(<part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>)";
const std::string kFan = "samples='91' min_angle='-45' max_angle='45' ";
std::string scanner(const std::string& attributes) {
  return R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" )" + attributes + "/>";
}

TEST_CASE("a scene without weather and one that only names it have the same scans at the same cost with every method") {
  for (const char* method : {"planar", "nearest", "hybrid", "raycast"}) {
    CAPTURE(method);
    const std::string commands = kWall + kCamera + scanner(kFan + "method='" + std::string(method) + "'");
    World plain({{"wall.gltf", wall()}}, commands);
    World named({{"wall.gltf", wall()}}, commands + fog("kind='rain' rain_rate='0'"));
    for (int frame = 0; frame < 3; ++frame) CHECK((frame_of(plain) == frame_of(named)));
  }
}

TEST_CASE(
    "beams are cast in weather with every method, and plan and report name the reason; clear air changes nothing") {
  for (const char* method : {"planar", "nearest", "hybrid", "auto"}) {
    CAPTURE(method);
    World world({{"wall.gltf", wall()}},
                kWall + scanner(kFan + "method='" + std::string(method) + "'") + fog("kind='rain' rain_rate='0'"));
    const ScanFrame clear = frame_of(world);
    CHECK(clear.effects == 0);
    world->set("FOG", "rain_rate", 0.1);
    const std::uint64_t rays = world->diagnostics().ray_counters().rays;
    const ScanFrame wet = frame_of(world);
    const FramePlan& plan = world->diagnostics().frame_plan();
    CHECK(plan.passes.empty());
    REQUIRE(plan.casts.size() == 1);
    CHECK(contains(plan.casts[0].reason, "every beam of laser scanner SCAN, for atmosphere"));
    REQUIRE(plan.effects.size() == 1);
    CHECK(plan.effects[0].effect == "atmosphere");
    CHECK(world->diagnostics().ray_counters().rays == rays + 91);
    const std::vector<SensorNote> notes = world->sensors()[0].report.notes;
    REQUIRE(!notes.empty());
    CHECK(notes[0].name == "cast_for");
    CHECK(std::get<std::string>(notes[0].value) == "atmosphere");
    // In drizzle the wall is the strongest echo. Ranges are stored as float32.
    constexpr double kStored_m = 8 * 0x1p-24;
    for (std::size_t beam = 0; beam < 91; ++beam) {
      const double a = (static_cast<double>(beam) - 45) * std::numbers::pi / 180;
      CHECK(std::abs(wet.range_m[beam] - 4 / std::cos(a)) <= wet.error_bound_m[beam] + kStored_m);
    }
    world->set("FOG", "rain_rate", 0);
    const ScanFrame again = frame_of(world);
    if (std::string_view(method) != "auto") CHECK(again.range_m == clear.range_m);  // auto surveys in its first frame
    CHECK(world->diagnostics().frame_plan().effects.empty());
  }
}

TEST_CASE("a wall is lost where its echo, by Beer and Lambert, is below the least power") {
  // A white wall at 4 m returns exp(-2 k 4) / 16 at perpendicular incidence, and the air less: pi 0.33 b.
  World world({{"wall.gltf", wall()}},
              kWall + scanner("samples='1' min_angle='0' max_angle='0' least_power='0.03'") + fog("visibility='500'"));
  const auto seen = [&](double visibility_m) {
    world->set("FOG", "visibility", visibility_m);
    world->step();
    return world->scan("SCAN").range_m[0];
  };
  // exp(-8 k) / 16 = 0.03 at k = 0.09175: visibility 42.64 m.
  CHECK(seen(42.7) == 4);  // a plane at a range that float32 represents exactly
  CHECK(std::isinf(seen(42.6)));
}

TEST_CASE("without a surface, dense fog returns an echo, and otherwise a miss stays a miss") {
  World world({{"wall.gltf", wall()}},
              kWall + scanner("samples='1' min_angle='180' max_angle='180'") + fog("visibility='500'"));
  const auto seen = [&](double visibility_m) {
    world->set("FOG", "visibility", visibility_m);
    world->step();
    return world->scan("SCAN").range_m[0];
  };
  // In thin fog the largest integral of the pulse is 0.397, at 1.29 m: pi 0.397 b is 0.1 / 80^2 = 1.56e-5 at
  // k = 2.36e-4 1/m: visibility 8.7 km (k is 3.912 / v 0.5232 there). In denser fog it is nearer.
  CHECK(std::abs(seen(500) - 1.28F) < 0.02F);
  CHECK(std::abs(seen(8500) - 1.29F) < 0.01F);
  CHECK(std::isinf(seen(8900)));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
