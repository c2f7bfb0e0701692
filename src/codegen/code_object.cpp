// A small loader: places the sections of relocatable objects in one mapping, applies the
// relocations that position-independent x86-64 code needs (System V ABI, AMD64 supplement,
// section 4.4), and makes it executable. Every offset is checked: a damaged file is refused, never
// followed.
#include "codegen/code_object.h"

#include <elf.h>
#include <sys/mman.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace pse {
namespace {

// What LLVM may call where the processor lacks an instruction, or to move memory.
const void* host_function(std::string_view name) {
  using F = float (*)(float);
  using F3 = float (*)(float, float, float);
  const auto address = [](auto* function) { return reinterpret_cast<const void*>(function); };
  if (name == "fmaf") return address(static_cast<F3>(&::fmaf));
  if (name == "floorf") return address(static_cast<F>(&::floorf));
  if (name == "ceilf") return address(static_cast<F>(&::ceilf));
  if (name == "truncf") return address(static_cast<F>(&::truncf));
  if (name == "memset") return address(&::memset);
  if (name == "memcpy") return address(&::memcpy);
  if (name == "memmove") return address(&::memmove);
  return nullptr;
}

// jmp *0(%rip), then the address: reaches functions further away than 2 GiB.
constexpr std::size_t stub_size = 16;
void write_stub(std::byte* place, const void* target) {
  constexpr unsigned char jump[6] = {0xff, 0x25, 0, 0, 0, 0};
  std::memcpy(place, jump, sizeof jump);
  std::memcpy(place + sizeof jump, &target, sizeof target);
}

constexpr std::size_t no_place = ~std::size_t{0};

// One object file: its sections and symbols as the file says, checked to lie inside it.
class ObjectFile {
 public:
  explicit ObjectFile(std::span<const std::byte> file) : file_(file) {}

  bool read_headers() {
    Elf64_Ehdr header;
    if (!read(0, header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) return false;
    if (header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_type != ET_REL ||
        header.e_machine != EM_X86_64)
      return false;
    for (std::size_t i = 0; i < header.e_shnum; ++i) {
      Elf64_Shdr section;
      if (!read(header.e_shoff + i * sizeof section, section)) return false;
      if (section.sh_type != SHT_NOBITS && !inside(section.sh_offset, section.sh_size))
        return false;
      sections.push_back(section);
    }
    return read_symbols();
  }

  template <class T>
  bool read(std::uint64_t offset, T& to) const {
    if (!inside(offset, sizeof(T))) return false;
    std::memcpy(&to, file_.data() + offset, sizeof(T));
    return true;
  }

  const std::byte* contents(const Elf64_Shdr& section) const {
    return file_.data() + section.sh_offset;
  }

  std::string_view name(std::size_t symbol) const {
    const std::size_t at = symbols[symbol].st_name;
    if (at >= names_.size()) return {};
    const std::string_view rest = names_.substr(at);
    return rest.substr(0, rest.find('\0'));
  }

  bool exports(std::size_t symbol) const {
    return ELF64_ST_BIND(symbols[symbol].st_info) == STB_GLOBAL &&
           symbols[symbol].st_shndx != SHN_UNDEF;
  }

  std::vector<Elf64_Shdr> sections;
  std::vector<Elf64_Sym> symbols;
  std::vector<std::size_t> places;  // per section: offset in the mapping
  std::size_t stubs = 0;            // likewise, of the first symbol's stub

 private:
  bool inside(std::uint64_t offset, std::uint64_t size) const {
    return offset <= file_.size() && size <= file_.size() - offset;
  }

  bool read_symbols() {
    for (const Elf64_Shdr& section : sections) {
      if (section.sh_type != SHT_SYMTAB) continue;
      if (section.sh_link >= sections.size()) return false;
      const Elf64_Shdr& strings = sections[section.sh_link];
      names_ = {reinterpret_cast<const char*>(file_.data()) + strings.sh_offset, strings.sh_size};
      for (std::uint64_t at = 0; at + sizeof(Elf64_Sym) <= section.sh_size;
           at += sizeof(Elf64_Sym)) {
        Elf64_Sym symbol;
        if (!read(section.sh_offset + at, symbol)) return false;
        symbols.push_back(symbol);
      }
    }
    return true;
  }

  std::span<const std::byte> file_;
  std::string_view names_;
};

// Several files as one mapping; what one file lacks another may have.
class Loader {
 public:
  bool read(std::span<const std::span<const std::byte>> objects) {
    for (const std::span<const std::byte> object : objects) {
      if (!files_.emplace_back(object).read_headers()) return false;
    }
    return true;
  }

  // Gives every section that is needed at run time its place, and one stub to every function of the
  // host.
  bool lay_out() {
    for (ObjectFile& file : files_) {
      for (const Elf64_Shdr& section : file.sections) {
        if (!place(file, section)) return false;
      }
      file.stubs = size_ = (size_ + 63) & ~std::size_t{63};
      size_ += stub_size * file.symbols.size();
      if (size_ > limit) return false;
    }
    for (const ObjectFile& file : files_) {
      for (std::size_t i = 0; i < file.symbols.size(); ++i) {
        std::size_t at;
        if (file.exports(i) && place_of(file, i, at)) exported_.emplace(file.name(i), at);
      }
    }
    return true;
  }

  std::size_t size() const { return size_; }

  bool fill(std::byte* memory) {
    for (const ObjectFile& file : files_) {
      for (std::size_t i = 0; i < file.sections.size(); ++i) {
        const Elf64_Shdr& section = file.sections[i];
        if (file.places[i] == no_place || section.sh_type == SHT_NOBITS) continue;
        std::memcpy(memory + file.places[i], file.contents(section), section.sh_size);
      }
      for (std::size_t i = 0; i < file.symbols.size(); ++i) {
        if (file.symbols[i].st_shndx != SHN_UNDEF) continue;
        if (const void* function = host_function(file.name(i)))
          write_stub(memory + file.stubs + stub_size * i, function);
      }
      for (const Elf64_Shdr& section : file.sections) {
        if (section.sh_type == SHT_RELA && !relocate(file, section, memory)) return false;
        if (section.sh_type == SHT_REL) return false;
      }
    }
    return true;
  }

  void export_symbols(const std::byte* memory,
                      std::unordered_map<std::string, const void*>& to) const {
    for (const auto& [name, at] : exported_) to.emplace(std::string(name), memory + at);
  }

 private:
  static constexpr std::size_t limit = std::size_t{1} << 30;

  bool place(ObjectFile& file, const Elf64_Shdr& section) {
    const bool needed = (section.sh_flags & SHF_ALLOC) != 0 &&
                        section.sh_type != SHT_X86_64_UNWIND && section.sh_type != SHT_NOTE;
    if (!needed || section.sh_size == 0) {
      file.places.push_back(no_place);
      return true;
    }
    const std::size_t align = section.sh_addralign > 64 ? section.sh_addralign : 64;
    if ((section.sh_flags & SHF_WRITE) != 0 || align > 4096 || (align & (align - 1)) != 0)
      return false;
    if (section.sh_size > limit) return false;
    size_ = (size_ + align - 1) & ~(align - 1);
    file.places.push_back(size_);
    size_ += section.sh_size;
    return size_ <= limit;
  }

  // Where a symbol is, from the start of the mapping.
  bool place_of(const ObjectFile& file, std::size_t index, std::size_t& at) const {
    if (index >= file.symbols.size()) return false;
    const Elf64_Sym& symbol = file.symbols[index];
    if (symbol.st_shndx == SHN_UNDEF) {
      if (const auto found = exported_.find(file.name(index)); found != exported_.end()) {
        at = found->second;
        return true;
      }
      at = file.stubs + stub_size * index;
      return host_function(file.name(index)) != nullptr;
    }
    if (symbol.st_shndx >= file.places.size() || file.places[symbol.st_shndx] == no_place)
      return false;
    if (symbol.st_value > file.sections[symbol.st_shndx].sh_size) return false;
    at = file.places[symbol.st_shndx] + symbol.st_value;
    return true;
  }

  bool relocate(const ObjectFile& file, const Elf64_Shdr& table, std::byte* memory) const {
    if (table.sh_info >= file.sections.size()) return false;
    const std::size_t target = file.places[table.sh_info];
    if (target == no_place) return true;  // of a section that is not loaded
    const std::size_t target_size = file.sections[table.sh_info].sh_size;
    for (std::uint64_t at = 0; at + sizeof(Elf64_Rela) <= table.sh_size; at += sizeof(Elf64_Rela)) {
      Elf64_Rela entry;
      std::size_t symbol;
      if (!file.read(table.sh_offset + at, entry) ||
          !place_of(file, ELF64_R_SYM(entry.r_info), symbol))
        return false;
      const auto type = ELF64_R_TYPE(entry.r_info);
      const std::size_t width = type == R_X86_64_64 ? 8 : 4;
      if (entry.r_offset > target_size || target_size - entry.r_offset < width) return false;
      std::byte* place = memory + target + entry.r_offset;
      if (type == R_X86_64_64) {
        const std::uint64_t value = reinterpret_cast<std::uintptr_t>(memory + symbol) +
                                    static_cast<std::uint64_t>(entry.r_addend);
        std::memcpy(place, &value, sizeof value);
      } else if (type == R_X86_64_PC32 || type == R_X86_64_PLT32) {
        // Unsigned, since a damaged object may say any number.
        const auto value = static_cast<std::int64_t>(
            symbol + static_cast<std::uint64_t>(entry.r_addend) - (target + entry.r_offset));
        const auto narrow = static_cast<std::int32_t>(value);
        if (narrow != value) return false;
        std::memcpy(place, &narrow, sizeof narrow);
      } else {
        return false;
      }
    }
    return true;
  }

  std::vector<ObjectFile> files_;
  std::unordered_map<std::string_view, std::size_t> exported_;  // places of global symbols
  std::size_t size_ = 0;
};

}  // namespace

std::expected<CodeObject, std::string> CodeObject::load(
    std::span<const std::span<const std::byte>> objects) {
  const auto refuse = [] {
    return std::unexpected(std::string("the compiled code cannot be loaded"));
  };
  Loader loader;
  if (!loader.read(objects) || !loader.lay_out()) return refuse();
  CodeObject code;
  const auto memory = code.map(loader.size());
  if (!memory) return std::unexpected(memory.error());
  if (!loader.fill(*memory)) return refuse();
  if (const auto done = code.make_executable(); !done) return std::unexpected(done.error());
  loader.export_symbols(*memory, code.symbols_);
  return code;
}

std::expected<CodeObject, std::string> CodeObject::from_code(std::span<const std::byte> bytes,
                                                             const std::string& symbol) {
  CodeObject code;
  const auto memory = code.map(bytes.size());
  if (!memory) return std::unexpected(memory.error());
  std::memcpy(*memory, bytes.data(), bytes.size());
  if (const auto done = code.make_executable(); !done) return std::unexpected(done.error());
  code.symbols_.emplace(symbol, *memory);
  return code;
}

std::expected<std::byte*, std::string> CodeObject::map(std::size_t size) {
  void* pages = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (pages == MAP_FAILED)
    return std::unexpected(std::string("there is no memory for compiled code"));
  pages_ = pages;
  size_ = size;
  return static_cast<std::byte*>(pages);
}

std::expected<void, std::string> CodeObject::make_executable() {
  if (mprotect(pages_, size_, PROT_READ | PROT_EXEC) != 0)
    return std::unexpected(std::string("the system does not allow compiled code to run"));
  return {};
}

CodeObject::CodeObject(CodeObject&& other) noexcept
    : pages_(std::exchange(other.pages_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      symbols_(std::move(other.symbols_)) {}

CodeObject& CodeObject::operator=(CodeObject&& other) noexcept {
  std::swap(pages_, other.pages_);
  std::swap(size_, other.size_);
  std::swap(symbols_, other.symbols_);
  return *this;
}

CodeObject::~CodeObject() {
  if (pages_) munmap(pages_, size_);
}

const void* CodeObject::find(const std::string& symbol) const {
  const auto found = symbols_.find(symbol);
  return found == symbols_.end() ? nullptr : found->second;
}

}  // namespace pse
