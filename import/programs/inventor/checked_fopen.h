// Takes the place of the C library's fopen() in the program that reads Inventor and VRML files.
#pragma once

namespace simvis {

class VrmlFiles;

/// From now on fopen() reads through `files`. Not reentrant.
/// `files` must live as long as files are opened.
void open_files_by(VrmlFiles& files);

/// Coin opens files by fopen(), and takes a failing read for the end of the file. With this fopen() it gets regular
/// files as files in memory, which are read before, so that a later read does not fail. If a fault of the
/// machine prevents the read, fopen() fails for Coin as for a missing file, and this function throws the reason.
void rethrow_read_fault();

}  // namespace simvis
