// What can go wrong with an image file, as a value. Every function of image/ that touches a file
// returns a Result.
#pragma once

#include <expected>
#include <string>

namespace pse::image {

enum class ErrorKind {
  // while reading
  not_found,     // there is no such file
  cannot_read,   // it is there and cannot be opened or read
  not_an_image,  // its first bytes belong to no format known here
  damaged,       // its content contradicts itself
  truncated,     // it ends too early
  too_large,     // it claims more pixels or bytes than the limits allow
  unsupported,   // a correct file of a kind that is not handled
  bad_request,   // asked for something the image does not have
  // while writing
  cannot_write,
  disk_full,
  not_finite,  // NaN or infinity where the policy is to refuse them
};

struct ImageError {
  ErrorKind kind = ErrorKind::damaged;
  std::string message;  // one sentence that names the file, and what to do where that is known

  // Whether the fault lies with what was to be written (exit status 5) and not with what was read
  // (4).
  bool is_output() const { return kind >= ErrorKind::cannot_write; }
};

template <class T>
using Result = std::expected<T, ImageError>;

inline std::unexpected<ImageError> fail(ErrorKind kind, std::string message) {
  return std::unexpected(ImageError{kind, std::move(message)});
}

}  // namespace pse::image
