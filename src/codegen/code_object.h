// Machine code in memory: relocatable ELF objects, fresh from LLVM or from the cache, made
// executable without LLVM. The last step before a kernel runs.
#pragma once

#include <cstddef>
#include <expected>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>

namespace pse {

// Owns the pages. The code can be called as long as this lives.
class CodeObject {
 public:
  // Takes x86-64 relocatable objects that together lack no symbols but the few functions of
  // code_object.cpp's list.
  static std::expected<CodeObject, std::string> load(
      std::span<const std::span<const std::byte>> objects);

  // Takes code that needs no relocation, with one function at its start.
  static std::expected<CodeObject, std::string> from_code(std::span<const std::byte> code,
                                                          const std::string& symbol);

  CodeObject(CodeObject&& other) noexcept;
  CodeObject& operator=(CodeObject&& other) noexcept;
  ~CodeObject();

  // The address of a global function, or null.
  const void* find(const std::string& symbol) const;
  std::size_t size() const { return size_; }

 private:
  CodeObject() = default;
  std::expected<std::byte*, std::string> map(std::size_t size);
  std::expected<void, std::string> make_executable();

  void* pages_ = nullptr;
  std::size_t size_ = 0;
  std::unordered_map<std::string, const void*> symbols_;
};

}  // namespace pse
