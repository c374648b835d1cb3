// What the program that reads stages of USD answers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include <simvis/part_importer.h>

namespace simvis {

/// The part in an answer, which is not trusted: the size of a JSON text in eight bytes, this text, which holds a glTF
/// document and the model (import/programs/usd/usd_physics.py), and the bytes that the document names. `y_up` turns the
/// part. Throws InputError naming `file`, the stage.
PartContent read_usd_answer(std::span<const std::uint8_t> answer, const std::filesystem::path& file, bool y_up,
                            ContentPool& pool);

}  // namespace simvis
