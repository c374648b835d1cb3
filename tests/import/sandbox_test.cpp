// Part files are read by a helper program: whatever happens to it, the caller gets an error in time.
#include <doctest/doctest.h>

#include <link.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/input_log.h"
#include "import/sandbox/import_answer.h"
#include "import/sandbox/import_program.h"
#include "import/sandbox/imported_scene.h"
#include "import/sandbox/sandbox_process.h"
#include "import/sandbox/sandboxed_import.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/random_numbers.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

using Bytes = std::vector<std::uint8_t>;

// Whether it has ended and its parent does not know yet.
bool is_zombie(pid_t process) {
  const std::string state = read_text("/proc/" + std::to_string(process) + "/stat");
  return state.find(") Z ") != std::string::npos;
}

ImportedScene triangle_scene() {
  ImportedScene scene;
  Mesh mesh;
  mesh.name = "M";
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.attributes.resize(3);
  mesh.indices = {0, 1, 2};
  scene.meshes = {mesh};
  ImportedTexture pixels, picture;
  pixels.texture.width = pixels.texture.height = 1;
  pixels.texture.rgba = {1, 2, 3, 4};
  pixels.texture.sampler.wrap_v = Wrap::mirrored_repeat;
  picture.file = picture.texture.name = "wood.png";
  scene.textures = {pixels, picture};
  ImportedMaterial material, fallback;
  material.material.name = "blue";
  material.material.base_color = {0.1f, 0.2f, 0.3f, 0.4f};
  material.material.double_sided = true;
  material.material.uv_set = 1;
  material.texture = 0;
  fallback.is_fallback = true;
  scene.materials = {material, fallback};
  ImportedNode shape, light;
  shape.name = "S";
  shape.parent_from_node = glm::dmat4(2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1);
  shape.shapes = {{0, 1}};
  light.parent = 0;
  light.light = Light{.kind = LightKind::spot, .intensity = 5};
  scene.nodes = {shape, light};
  scene.commands = {"<part/>"};
  scene.warnings = {"careful"};
  return scene;
}

std::string fault_after(void (*change)(ImportedScene&)) {
  ImportedScene scene = triangle_scene();
  change(scene);
  return error_of([&] { unpack_imported_scene(pack_imported_scene(scene), "a.iv: error: "); });
}

// Whether the bytes are accepted as a scene. If they are, checks that it is sound.
bool is_taken(std::span<const std::uint8_t> bytes) {
  try {
    const ImportedScene scene = unpack_imported_scene(bytes, "");
    for (const Mesh& mesh : scene.meshes) {
      for (const std::uint32_t index : mesh.indices) REQUIRE(index < mesh.positions.size());
    }
    return true;
  } catch (const InputError&) {
    return false;
  }
}

// The answer of a program with the scene and some messages.
Bytes answer_of(const ImportedScene& scene) {
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  AnswerWriter writer(ends[1]);
  writer.add(AnswerKind::warning, "mind the gap");
  writer.add(AnswerKind::scene, pack_imported_scene(scene));
  ::close(ends[1]);
  Bytes bytes(std::size_t{1} << 16);
  bytes.resize(static_cast<std::size_t>(::read(ends[0], bytes.data(), bytes.size())));
  ::close(ends[0]);
  return bytes;
}

// A program that runs the given shell commands.
std::filesystem::path script(const TemporaryFolder& folder, const std::string& commands) {
  static int number = 0;
  const std::filesystem::path file = folder / ("program_" + std::to_string(++number));
  write_text(file, "#!/bin/sh\n" + commands + "\n");
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  return file;
}

SandboxReport run(const std::filesystem::path& program, std::chrono::milliseconds time = std::chrono::seconds(10)) {
  return run_in_sandbox({.program = program, .arguments = {}, .time = time});
}

std::string answer_text(const GrowingBytes& answer) { return {answer.bytes().begin(), answer.bytes().end()}; }

SandboxedImport import_with(const std::filesystem::path& program) {
  SandboxedImport import;
  import.program = program;
  import.library = "Assimp";
  import.file = "part.stl";
  return import;
}

}  // namespace

TEST_CASE("an answer of any size arrives") {
  const TemporaryFolder folder;
  const SandboxReport report = run(script(folder, "head -c 3000000 /dev/zero >&3"));
  CHECK(fault_of(report.end).blame == Blame::nobody);
  CHECK(std::ranges::equal(report.answer.bytes(), Bytes(3'000'000, 0)));
}

TEST_CASE("a program has no open files but its answer, and no signal mask") {
  const TemporaryFolder folder;
  const int leak = ::dup(STDOUT_FILENO);  // an open file without close-on-exec, as in host programs
  const SandboxReport report =
      run(script(folder, "ls /proc/self/fd >&3; read line || echo none >&3; echo out; echo err >&2"));
  ::close(leak);
  // The last one is the folder that ls reads.
  CHECK(answer_text(report.answer) == "0\n1\n2\n3\n4\nnone\n");
}

TEST_CASE("a program that crashes, fails or hangs is reported as such, with its earlier messages") {
  const TemporaryFolder folder;
  const SandboxReport crashed = run(script(folder, "printf before >&3; kill -SEGV $$"));
  CHECK(fault_of(crashed.end).blame == Blame::helper);
  CHECK(contains(fault_of(crashed.end).reason, "Segmentation fault"));
  CHECK(answer_text(crashed.answer) == "before");

  const SandboxReport failed = run(script(folder, "exit 3"));
  CHECK(fault_of(failed.end).blame == Blame::helper);
  CHECK(fault_of(failed.end).reason == "ended with exit status 3");

  // It would never end, and uses no processor. The machine may be busy.
  constexpr std::chrono::seconds kPatience{10};
  for (const char* hanging : {"printf before >&3; exec sleep 1000", "printf before >&3; exec 3>&-; exec sleep 1000"}) {
    const auto start = std::chrono::steady_clock::now();
    const SandboxReport hung = run_in_sandbox(
        {.program = script(folder, hanging), .arguments = {}, .wall_time = std::chrono::milliseconds(500)});
    CHECK(hung.end.kind == HelperEndKind::out_of_wall_time);
    CHECK(fault_of(hung.end).blame == Blame::machine);
    CHECK(answer_text(hung.answer) == "before");
    CHECK(std::chrono::steady_clock::now() - start < kPatience);
  }
}

TEST_CASE("the time of a program is that of its processor, so that a busy machine does not end it") {
  const TemporaryFolder folder;
  constexpr std::chrono::milliseconds kTime{400};
  // It needs more than the time by the clock, in which others have the processor.
  const SandboxReport slow = run(script(folder, "printf before >&3; sleep 1; printf after >&3"), kTime);
  CHECK(fault_of(slow.end).blame == Blame::nobody);
  CHECK(answer_text(slow.answer) == "beforeafter");
  CHECK(slow.end.wall_time > kTime);

  const SandboxReport stopped = run_in_sandbox({.program = script(folder, "printf before >&3; kill -STOP $$"),
                                                .arguments = {},
                                                .wall_time = std::chrono::milliseconds(300)});
  CHECK(stopped.end.kind == HelperEndKind::out_of_wall_time);
  CHECK(answer_text(stopped.answer) == "before");

  const SandboxReport busy = run(script(folder, "printf before >&3; while :; do :; done"), kTime);
  CHECK(busy.end.kind == HelperEndKind::out_of_processor_time);
  CHECK(busy.end.processor_time >= kTime);
  CHECK(answer_text(busy.answer) == "before");
}

TEST_CASE("whose fault it is that a program has no result") {
  const auto blame = [](HelperEndKind kind, int number) { return fault_of({.kind = kind, .number = number}).blame; };
  CHECK(blame(HelperEndKind::exited, 0) == Blame::nobody);
  CHECK(blame(HelperEndKind::exited, 1) == Blame::helper);
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGSYS}) {
    CHECK(blame(HelperEndKind::killed, signal) == Blame::helper);
  }
  for (const int signal : {SIGKILL, SIGBUS, SIGXCPU, SIGXFSZ, SIGTERM, SIGINT, SIGHUP, SIGPIPE}) {
    CHECK(blame(HelperEndKind::killed, signal) == Blame::machine);
  }
  for (const HelperEndKind kind :
       {HelperEndKind::out_of_processor_time, HelperEndKind::out_of_wall_time, HelperEndKind::answered_without_end}) {
    CHECK(blame(kind, 0) == Blame::machine);
  }
  ImportAnswer answer;
  answer.refusal = "is broken";
  CHECK(fault_of({}, answer).blame == Blame::file);
  CHECK(fault_of({.kind = HelperEndKind::killed, .number = SIGKILL}, answer).blame == Blame::machine);
  answer.machine_fault = "the disk fails";
  CHECK(fault_of({}, answer).blame == Blame::machine);
  CHECK(fault_of({}, answer).reason == "the disk fails");
}

TEST_CASE("an endless answer is refused") {
  const TemporaryFolder folder;
  SandboxCall call{.program = script(folder, "exec cat /dev/zero >&3"), .arguments = {}};
  call.answer_bytes = 1'000'000;
  const SandboxReport report = run_in_sandbox(call);
  CHECK(report.end.kind == HelperEndKind::answered_without_end);
  CHECK(report.answer.bytes().size() == call.answer_bytes);
}

TEST_CASE("no process that a program has started goes on, even if it keeps the answer open") {
  const TemporaryFolder folder;
  const std::string number = (folder / "number").string();
  SandboxCall call{.program = script(folder, "sleep 300 & echo $! > " + number + "; echo answer >&3"), .arguments = {}};
  const SandboxReport report = run_in_sandbox(call);
  CHECK(report.end.kind == HelperEndKind::exited);
  CHECK(report.end.wall_time < std::chrono::seconds(60));
  CHECK(answer_text(report.answer) == "answer\n");
  const pid_t started = std::stoi(read_text(number));
  // Killed, and perhaps not collected yet by the process that adopts it.
  for (int i = 0; i < 1000 && ::kill(started, 0) == 0 && !is_zombie(started); ++i) ::usleep(1000);
  CHECK((::kill(started, 0) != 0 || is_zombie(started)));
}

TEST_CASE("a program sees the variables of its call alone if it inherits none") {
  const TemporaryFolder folder;
  SandboxCall call{.program = script(folder, "env >&3"), .arguments = {}, .environment = {"OWN=1"}};
  ::setenv("SIMVIS_TEST_INHERITED", "1", 1);
  CHECK(contains(answer_text(run_in_sandbox(call).answer), "SIMVIS_TEST_INHERITED=1"));
  call.inherits_environment = false;
  const std::string seen = answer_text(run_in_sandbox(call).answer);
  ::unsetenv("SIMVIS_TEST_INHERITED");
  CHECK(contains(seen, "OWN=1"));
  CHECK(seen.find("SIMVIS_TEST_INHERITED") == std::string::npos);
}

TEST_CASE("a program names only files of its folders as those that it has read") {
  const TemporaryFolder folder, other;
  write_text(folder / "part.stl", "x");
  write_text(other / "secret", "x");
  const std::string own = (folder / "part.stl").string(), secret = (other / "secret").string();
  const auto input = [](const std::string& name) {
    char size[64];
    std::snprintf(size, sizeof size, "I\\%03o\\000\\000\\000\\000\\000\\000\\000", static_cast<unsigned>(name.size()));
    return std::string(size) + name;
  };
  SandboxedImport import = import_with(script(folder, "printf 'simvis-import-5\\n" + input(own) + input(secret) +
                                                          "S\\000\\000\\000\\000\\000\\000\\000\\000' >&3"));
  import.file = own;
  const InputLog inputs;
  ask_in_sandbox(import);
  CHECK(inputs.files().contains(own));
  CHECK_FALSE(inputs.files().contains(secret));
}

TEST_CASE("a program that is missing or cannot run is named") {
  const TemporaryFolder folder;
  const auto error = [&](const std::filesystem::path& program) {
    return machine_error_of([&] { import_in_sandbox(import_with(program)); });
  };
  CHECK(error(folder / "none") == "cannot start " + (folder / "none").string() +
                                      ", the helper program that reads part files: No such file or directory");
  write_text(folder / "plain", "text");
  CHECK(contains(error(folder / "plain"), "plain, the helper program that reads part files: Permission denied"));
  CHECK(contains(error(script(folder, "exit 127")), "a shared library is missing"));
}

TEST_CASE("the programs of the tested build are in the folder of its library") {
  const std::filesystem::path program = import_program("simvis-import-mesh");
  CHECK(std::filesystem::exists(program));
  CHECK(program == std::filesystem::canonical(tested_build()) / "lib" / "simvis" / "simvis-import-mesh");
}

TEST_CASE("a program that crashes, hangs or answers nonsense is an error with the file's name") {
  const TemporaryFolder folder;
  SandboxedImport import = import_with(script(folder, "kill -SEGV $$"));
  CHECK(error_of([&] { import_in_sandbox(import); }) == "part.stl: error: Assimp crashed (Segmentation fault)");
  const auto error = [&] { return machine_error_of([&] { import_in_sandbox(import); }); };
  import.program = script(folder, "kill -KILL $$");
  CHECK(contains(error(), "part.stl: error: Assimp was killed (Killed)"));
  import.program = script(folder, "while :; do :; done");
  import.least.time = std::chrono::milliseconds(100);
  CHECK(contains(error(), "part.stl: error: Assimp did not finish in 1"));
  import.least.time = std::chrono::seconds(10);
  import.program = script(folder, "exec cat /dev/zero >&3");
  import.least.memory_bytes = std::size_t{8} << 20;
  CHECK(
      contains(error(), "part.stl: error: Assimp gave more content than fits into the memory that it may use; a file"));
}

TEST_CASE("messages are kept on one line, once, and within limits") {
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  AnswerWriter writer(ends[1]);
  for (const char* text : {"one\ntwo", "one\ntwo", "\xff\xc3\xa9"}) writer.add(AnswerKind::warning, text);
  const std::string line(1000, 'x');
  constexpr int kLines = 60;  // fit into the pipe, which is not read yet
  for (int i = 0; i < kLines; ++i) writer.add(AnswerKind::error, std::to_string(i) + line);
  writer.add(AnswerKind::error, std::string(kMaxMessageBytes, 'y'));
  writer.add(AnswerKind::refusal, "no");
  ::close(ends[1]);
  Bytes bytes(std::size_t{1} << 17);
  bytes.resize(static_cast<std::size_t>(::read(ends[0], bytes.data(), bytes.size())));
  ::close(ends[0]);
  const ImportAnswer answer = read_import_answer(bytes);
  CHECK(answer.warnings == std::vector<std::string>{"one two", "???"});
  CHECK(answer.errors.size() == kLines);
  CHECK(answer.refusal == "no");
  CHECK_FALSE(answer.scene);
}

TEST_CASE("a file that takes more memory than allowed is an error with its name") {
  if (sanitized()) return test::skip(test::kNotSanitized);  // its memory is not limited
  const TemporaryFolder folder;
  // Two bytes are a piece of a line: 28 bytes for its two corners, and twice that while arrays grow.
  std::string text = "v 0 0 0\nl";
  for (int i = 0; i < 1'000'000; ++i) text += " 1";
  write_text(folder / "large.obj", text);
  SandboxedImport import = import_with(import_program("simvis-import-mesh"));
  import.file = folder / "large.obj";
  import.least.memory_bytes = std::size_t{1} << 20;
  const std::string said = machine_error_of([&] { import_in_sandbox(import); });
  CHECK(contains(said, import.file.string() + ": error: reading takes more than 16 MiB of memory; a file may be large: "
                                              "SIMVIS_IMPORT_FACTOR=2 in the environment doubles the limits"));
}

TEST_CASE("limits grow with the file and with a variable") {
  using std::chrono::milliseconds;
  const ImportLimits least{.time = milliseconds(10'000), .memory_bytes = std::size_t{4} << 30};
  const auto is = [&](std::uintmax_t bytes, milliseconds time, std::size_t memory_bytes) {
    const ImportLimits limits = limits_for(least, bytes);
    CHECK(limits.time == time);
    CHECK(limits.memory_bytes == memory_bytes);
  };
  is(0, milliseconds(10'000), least.memory_bytes);
  is(std::uintmax_t{100} << 20, milliseconds(35'000), least.memory_bytes + (std::size_t{800} << 20));
  const ImportLimits of_largest = limits_for(least, std::uintmax_t{1} << 30);
  is(std::uintmax_t{1} << 40, of_largest.time, of_largest.memory_bytes);  // a file of holes
  ::setenv("SIMVIS_IMPORT_FACTOR", "2.5", 1);
  is(std::uintmax_t{100} << 20, milliseconds(87'500), least.memory_bytes / 2 * 5 + (std::size_t{2000} << 20));
  for (const char* const wrong : {"0.5", "x", "1001", "nan", "-1"}) {
    ::setenv("SIMVIS_IMPORT_FACTOR", wrong, 1);
    CHECK(contains(error_of([&] { limits_for(least, 0); }), "variable SIMVIS_IMPORT_FACTOR: "));
  }
  ::unsetenv("SIMVIS_IMPORT_FACTOR");
}

TEST_CASE("the variable raises the number of points of a file") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const TemporaryFolder folder;
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex 20000001\n";
  for (const char axis : {'x', 'y', 'z'}) text += std::string("property float ") + axis + "\n";
  write_text(folder / "p.ply", text + "end_header\n");
  SandboxedImport import = import_with(import_program("simvis-import-mesh"));
  import.file = folder / "p.ply";
  const auto error = [&] { return error_of([&] { import_in_sandbox(import); }); };
  CHECK(
      contains(error(), "has 20000001 points, expected at most 20000000; a file may be large: SIMVIS_IMPORT_FACTOR=2"));
  ::setenv("SIMVIS_IMPORT_FACTOR", "2", 1);
  CHECK(contains(error(), "ends too early: its header claims 20000001 points"));
  ::unsetenv("SIMVIS_IMPORT_FACTOR");
}

TEST_CASE("several threads read files side by side") {
  const TemporaryFolder folder;
  write_text(folder / "box.stl", stl_box(true));
  constexpr int kThreads = 4, kFiles = 5;
  std::vector<std::size_t> triangles(kThreads);
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, i] {
      for (int k = 0; k < kFiles; ++k) {
        SandboxedImport import = import_with(import_program("simvis-import-mesh"));
        import.file = folder / "box.stl";
        triangles[i] += import_in_sandbox(import).meshes.at(0).indices.size() / 3;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(triangles == std::vector<std::size_t>(kThreads, kFiles * 12));
}

TEST_CASE("a scene survives serialisation unchanged") {
  const ImportedScene scene = unpack_imported_scene(pack_imported_scene(triangle_scene()), "");
  const ImportedScene expected = triangle_scene();
  CHECK(scene.meshes == expected.meshes);
  REQUIRE(scene.textures.size() == 2);
  CHECK(scene.textures[0].texture == expected.textures[0].texture);
  CHECK(scene.textures[1].texture == expected.textures[1].texture);
  CHECK(scene.textures[1].file == "wood.png");
  REQUIRE(scene.materials.size() == 2);
  CHECK(scene.materials[0].material == expected.materials[0].material);
  CHECK(scene.materials[0].texture == 0);
  CHECK_FALSE(scene.materials[0].is_fallback);
  CHECK(scene.materials[1].is_fallback);
  REQUIRE(scene.nodes.size() == 2);
  CHECK(scene.nodes[0].name == "S");
  CHECK(scene.nodes[0].parent == kNoParent);
  CHECK(scene.nodes[0].parent_from_node == expected.nodes[0].parent_from_node);
  REQUIRE(scene.nodes[0].shapes.size() == 1);
  CHECK(scene.nodes[0].shapes[0].material == 1);
  CHECK(scene.nodes[1].parent == 0);
  REQUIRE(scene.nodes[1].light);
  CHECK(*scene.nodes[1].light == *expected.nodes[1].light);
  CHECK(scene.commands == expected.commands);
  CHECK(scene.warnings == expected.warnings);
}

TEST_CASE("a scene with a fault is refused") {
  using Scene = ImportedScene;
  CHECK(contains(fault_after([](Scene& s) { s.meshes[0].positions[1].y = NAN; }), "not finite"));
  CHECK(contains(fault_after([](Scene& s) { s.meshes[0].attributes[0].normal.x = INFINITY; }), "not finite"));
  CHECK(contains(fault_after([](Scene& s) { s.meshes[0].indices[0] = 3; }), "index"));
  CHECK(contains(fault_after([](Scene& s) { s.meshes[0].indices.pop_back(); }), "an incomplete primitive"));
  CHECK(contains(fault_after([](Scene& s) { s.meshes[0].attributes.pop_back(); }), "attributes"));
  CHECK(contains(fault_after([](Scene& s) { s.textures[0].texture.width = 2; }), "bytes do not match its size"));
  CHECK(contains(fault_after([](Scene& s) { s.textures[1].texture.width = 2; }), "two images"));
  CHECK(contains(fault_after([](Scene& s) { s.materials[0].texture = 2; }), "with an unknown texture"));
  CHECK(contains(fault_after([](Scene& s) { s.materials[0].material.uv_set = 2; }), "third set"));
  CHECK(contains(fault_after([](Scene& s) { s.nodes[0].shapes[0].mesh = 1; }), "unknown mesh or material"));
  CHECK(contains(fault_after([](Scene& s) { s.nodes[0].shapes[0].material = 2; }), "unknown mesh or material"));
  CHECK(contains(fault_after([](Scene& s) { s.nodes[0].parent_from_node[0][3] = 1; }), "not affine"));
  CHECK(contains(fault_after([](Scene& s) { s.nodes[1].parent = 1; }), "before its parent"));
  CHECK(contains(fault_after([](Scene& s) { s.nodes[1].light->intensity = NAN; }), "not finite"));
}

TEST_CASE("truncated and flipped answers are refused or harmless") {
  const Bytes whole = pack_imported_scene(triangle_scene());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CHECK_THROWS_AS(unpack_imported_scene({whole.data(), size}, ""), InputError);
  }
  int refused = 0;
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    Bytes bytes = whole;
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1u << (bit % 8)));
    refused += !is_taken(bytes);
  }
  CHECK(refused > 0);
}

TEST_CASE("an answer with any bytes can be read without harm") {
  constexpr int kAnswers = 20'000;
  Random random;
  const Bytes whole = answer_of(triangle_scene());
  CHECK(read_import_answer(whole).scene);
  int with_scene = 0, taken = 0;
  for (int i = 0; i < kAnswers; ++i) {
    Bytes bytes = whole;
    for (std::uint64_t change = 1 + random.below(4); change > 0; --change) {
      const std::size_t at = random.below(bytes.size());
      if (random.below(3) == 0) {
        // A size or an index of any magnitude at a place where one is allowed.
        const std::uint64_t number = (std::uint64_t{1} << random.below(64)) - random.below(2);
        std::memcpy(bytes.data() + at, &number, std::min(sizeof number, bytes.size() - at));
      } else {
        bytes[at] = static_cast<std::uint8_t>(random.below(256));
      }
    }
    if (random.below(8) == 0) bytes.resize(random.below(bytes.size()));
    const ImportAnswer answer = read_import_answer(bytes);
    if (!answer.scene) continue;
    ++with_scene;
    taken += is_taken(*answer.scene);
  }
  // Both parsers were reached, and both results occurred.
  CHECK(with_scene > kAnswers / 10);
  CHECK(taken > 0);
  CHECK(taken < with_scene);
}

TEST_CASE("an answer of another version, a missing answer and a truncated one are errors with the file's name") {
  const TemporaryFolder folder;
  const auto error_after = [&](const Bytes& answer) {
    write_bytes(folder / "answer", answer);
    return machine_error_of(
        [&] { import_in_sandbox(import_with(script(folder, "cat '" + (folder / "answer").string() + "' >&3"))); });
  };
  const Bytes whole = answer_of(triangle_scene());
  CHECK(error_after(whole) == "nothing was thrown");
  Bytes other = whole;
  other[0] ^= 1;
  CHECK(error_after(other) == "part.stl: error: the helper program that read it returned nothing");
  CHECK(error_after({}) == "part.stl: error: the helper program that read it returned nothing");
  CHECK(error_after({whole.begin(), whole.end() - 1}) ==
        "part.stl: error: the helper program that read it returned nothing; mind the gap");
  Bytes torn = whole;
  torn.back() ^= 1;  // the last byte of a warning's text: harmless
  CHECK(error_after(torn) == "nothing was thrown");
}

TEST_SUITE_END();
