// What the helper programs read, in this process, and their answers as SimVis reads them.
#include <fcntl.h>

#include <exception>
#include <stdexcept>

#include <simvis/error.h>
#include "import/programs/decode/any_picture.h"
#include "import/programs/decode/draco_reader.h"
#include "import/programs/part_reader.h"
#include "import/sandbox/draco_mesh.h"
#include "import/sandbox/import_answer.h"
#include "import/sandbox/imported_scene.h"
#include "tests/fuzz/fuzz_target.h"

namespace simvis::fuzz {
namespace {

/// A helper program reports every std::exception as the reason why the file is refused.
template <typename Work>
void as_helper(const Work& work) {
  try {
    work();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError(error.what());
  }
}

// What a helper program answers is checked like a file.
void read_back(ImportedScene scene) { unpack_imported_scene(pack_imported_scene(std::move(scene)), "fuzz"); }

void read_mesh(Input input, const char* name) {
  as_helper([&] {
    static const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    AnswerWriter answer(nowhere);
    read_back(read_part({.file = input_file(name, input)}, answer));
  });
}
void read_obj(Input input) { read_mesh(input, "part.obj"); }
void read_ply(Input input) { read_mesh(input, "part.ply"); }
void read_stl(Input input) { read_mesh(input, "part.stl"); }
void read_pcd_file(Input input) { read_mesh(input, "part.pcd"); }
void read_las_file(Input input) { read_mesh(input, "part.las"); }
void read_spz_file(Input input) { read_mesh(input, "part.spz"); }
void read_dae(Input input) { read_mesh(input, "part.dae"); }
void read_zae(Input input) { read_mesh(input, "part.zae"); }

void read_picture(Input input) {
  as_helper([&] { decode_any_picture(input, "fuzz"); });
}

void read_draco_data(Input input) {
  as_helper([&] {
    const DracoAttribute attributes[] = {{.id = 0, .component_type = 5126, .components = 3}};
    const DracoMesh mesh = read_draco(input, attributes);
    DracoMesh back;
    if (!unpack_draco_mesh(pack_draco_mesh(mesh), attributes, back)) throw std::runtime_error("it is malformed");
  });
}

void read_answer(Input input) {
  InputBytes bytes(input);
  const std::uint8_t kind = bytes.byte();
  if (kind % 3 == 0) {
    const ImportAnswer answer = read_import_answer(bytes.rest());
    if (answer.scene) unpack_imported_scene(*answer.scene, "fuzz");
  } else if (kind % 3 == 1) {
    unpack_imported_scene(bytes.rest(), "fuzz");
  } else {
    const DracoAttribute attributes[] = {{.id = 0, .component_type = 5126, .components = 3}};
    DracoMesh mesh;
    unpack_draco_mesh(bytes.rest(), attributes, mesh);
  }
}

const TargetRegistration kObj("obj", read_obj);
const TargetRegistration kPly("ply", read_ply);
const TargetRegistration kStl("stl", read_stl);
const TargetRegistration kSpz("spz", read_spz_file);
const TargetRegistration kPcd("pcd", read_pcd_file);
const TargetRegistration kLas("las", read_las_file);
const TargetRegistration kDae("dae", read_dae);
const TargetRegistration kZae("zae", read_zae);
const TargetRegistration kPicture("picture", read_picture);
const TargetRegistration kDraco("draco", read_draco_data);
const TargetRegistration kAnswer("answer", read_answer);

}  // namespace
}  // namespace simvis::fuzz
