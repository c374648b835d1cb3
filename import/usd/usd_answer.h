// What the program that reads stages of USD answers.
#pragma once

#include <cstdint>
#include <span>

#include <simvis/part_importer.h>

namespace simvis {

/// The part in an answer, which is not trusted: the size of a JSON text in eight bytes, this text, which holds a glTF
/// document, the model (import/programs/usd/usd_physics.py) and what is shown (import/programs/usd/usd_absent.py), and
/// the bytes that the document names. Throws InputError naming the requested file, the stage; also where more than half
/// of its visuals are missing, unless the request allows that.
PartContent read_usd_answer(std::span<const std::uint8_t> answer, const ImportRequest& request, ContentPool& pool);

}  // namespace simvis
