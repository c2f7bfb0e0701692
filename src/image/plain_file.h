// The two things that reading from pipes (byte_source.cpp) and writing (output_file.cpp) both need
// of the system: a file without a name, and writing all of something.
#pragma once

#include <cstddef>
#include <string>

namespace pse::image {

// $TMPDIR, or /tmp.
std::string temporary_folder();
// An open file in that folder that nobody sees and that goes with its last descriptor; -1 with
// errno where the system refuses.
int nameless_file();
// False with errno where the system does not take everything.
bool write_all(int file, const void* from, std::size_t count);

}  // namespace pse::image
