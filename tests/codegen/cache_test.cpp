// Compiled kernels on disk: found again, never trusted when damaged, bounded in size; the loader
// refuses damaged objects.
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "codegen/code_object.h"
#include "codegen/kernel_cache.h"
#include "codegen/module_hash.h"
#include "kernel_fixture.h"

namespace pse::testing_support {
namespace {

namespace fs = std::filesystem;
using ir::Op;

class Folder {
 public:
  explicit Folder(const std::string& name)
      : path(fs::path(::testing::TempDir()) / ("pse_cache_" + name)) {
    fs::remove_all(path);
  }
  ~Folder() { fs::remove_all(path); }
  fs::path path;
};

void emit_sum(TestProgram& program, float add) {
  ir::Builder& b = program.build;
  program.output(b.emit(Op::fadd, {program.input(), b.const_f32(add)}));
  program.finish();
}

// Compiles with a cache, checks what it computes, and says whether it came from the cache.
bool compile_and_run(const TestProgram& program, const fs::path& folder, float expected,
                     int width = 0) {
  CodegenOptions options;
  options.cache = folder;
  options.width = width;
  CodegenStats stats;
  const auto kernel = compile_kernel(program.split, options, &stats);
  EXPECT_TRUE(kernel) << kernel.error();
  Runner once;
  EXPECT_EQ(once(**kernel, program.split.module, {0}, {{1, 2}}, 2)[0][1], expected);
  return stats.from_cache;
}

TEST(Cache, ASecondCompilationIsFound) {
  const Folder folder("second");
  TestProgram program;
  emit_sum(program, 5);
  EXPECT_FALSE(compile_and_run(program, folder.path, 7));
  EXPECT_TRUE(compile_and_run(program, folder.path, 7));
  EXPECT_FALSE(compile_and_run(program, folder.path, 7, 4));
}

TEST(Cache, AnotherProgramIsAnotherEntry) {
  const Folder folder("another");
  TestProgram five, six;
  emit_sum(five, 5);
  emit_sum(six, 6);
  EXPECT_FALSE(compile_and_run(five, folder.path, 7));
  EXPECT_FALSE(compile_and_run(six, folder.path, 8));
}

TEST(Cache, NamesAndPlacesDoNotMatter) {
  TestProgram a, b;
  emit_sum(a, 5);
  emit_sum(b, 5);
  b.split.module.inputs[0].name = "other";
  b.split.module.functions[0].name = "renamed";
  Hasher ha, hb;
  hash_program(ha, a.split);
  hash_program(hb, b.split);
  EXPECT_EQ(ha.finish(), hb.finish());
}

TEST(Cache, ADamagedEntryIsCompiledAgain) {
  const Folder folder("damaged");
  TestProgram program;
  emit_sum(program, 5);
  compile_and_run(program, folder.path, 7);
  const fs::path entry = fs::directory_iterator(folder.path)->path();
  std::string good;
  {
    std::ostringstream text;
    text << std::ifstream(entry, std::ios::binary).rdbuf();
    good = text.str();
  }
  const auto write = [&](const std::string& content) {
    std::ofstream(entry, std::ios::binary) << content;
  };
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{5}, good.size() / 2, good.size() - 1}) {
    write(good.substr(0, length));
    EXPECT_FALSE(compile_and_run(program, folder.path, 7)) << length;
  }
  for (std::size_t at = 0; at < good.size(); at += good.size() / 20) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    write(bad);
    EXPECT_FALSE(compile_and_run(program, folder.path, 7)) << at;
  }
  EXPECT_TRUE(compile_and_run(program, folder.path, 7));
}

TEST(Cache, ManyWritersLeaveOneWholeEntry) {
  const Folder folder("writers");
  const KernelCache cache(folder.path);
  const Hash128 key{1, 2};
  std::vector<std::thread> writers;
  for (int t = 0; t < 4; ++t) {
    writers.emplace_back([&] {
      for (int i = 0; i < 20; ++i) {
        cache.keep(key, std::string(10000, 'x'));
        const auto found = cache.find(key);
        EXPECT_TRUE(found && *found == std::string(10000, 'x'));
      }
    });
  }
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()), 1);
}

TEST(Cache, TheLeastRecentlyUsedGoFirst) {
  const Folder folder("limit");
  const KernelCache cache(folder.path, 3500);
  const std::string object(1000, 'x');
  const auto now = fs::file_time_type::clock::now();
  for (std::uint64_t i = 0; i < 3; ++i) {
    cache.keep({0, i}, object);
    fs::last_write_time(folder.path / (Hash128{0, i}.text() + ".kernel"),
                        now - std::chrono::hours(10 - i));
  }
  EXPECT_TRUE(cache.find({0, 0}));  // now the most recent
  cache.keep({0, 3}, object);
  EXPECT_TRUE(cache.find({0, 0}));
  EXPECT_FALSE(cache.find({0, 1}));
  EXPECT_TRUE(cache.find({0, 2}));
  EXPECT_TRUE(cache.find({0, 3}));
}

TEST(Cache, AFolderThatCannotBeWrittenIsNoError) {
  TestProgram program;
  emit_sum(program, 5);
  EXPECT_FALSE(compile_and_run(program, "/proc/nothing/here", 7));
}

// The best width: two vectors at a time where the program is small.
TEST(Options, SmallProgramsOverlapTwoVectors) {
  for (const int additions : {10, 1000}) {
    TestProgram program;
    ir::Value sum = program.input();
    for (int i = 0; i < additions; ++i) sum = program.build.emit(Op::fadd, {sum, sum});
    program.output(sum);
    program.finish();
    CodegenOptions options;
    options.cpu = "x86-64-v4-vbmi";
    const auto text = emit_listing(program.split, options, Listing::llvm);
    ASSERT_TRUE(text);
    EXPECT_NE(text->find(additions == 10 ? "fadd <32 x float>" : "fadd <16 x float>"),
              std::string::npos);
  }
}

// Any byte of an object changed: it is refused or loaded, and nothing outside is touched.
TEST(CodeObject, DamagedObjectsAreHandled) {
  const Folder folder("object");
  TestProgram program;
  emit_sum(program, 5);
  compile_and_run(program, folder.path, 7);
  std::ostringstream text;
  text << std::ifstream(fs::directory_iterator(folder.path)->path(), std::ios::binary).rdbuf();
  const std::string object =
      text.str().substr(text.str().find("\x7f"
                                        "ELF"));
  const auto load = [](std::span<const char> bytes) {
    const std::span<const std::byte> one[] = {std::as_bytes(bytes)};
    return CodeObject::load(one).has_value();
  };
  ASSERT_TRUE(load(object));
  for (std::size_t at = 0; at < object.size(); ++at) {
    for (const int flip : {1, 0x80, 0xff}) {
      std::string bad = object;
      bad[at] = static_cast<char>(bad[at] ^ flip);
      static_cast<void>(load(bad));
    }
  }
  for (std::size_t length = 0; length < object.size(); length += 7) {
    static_cast<void>(load(std::span(object).first(length)));
  }
}

TEST(Options, MistakesAreSaidInASentence) {
  TestProgram program;
  emit_sum(program, 5);
  CodegenOptions width;
  width.width = 3;
  EXPECT_EQ(compile_kernel(program.split, width).error(),
            "a vector cannot have 3 samples; 1, 4, 8, 16 and 32 are possible");
  CodegenOptions cpu;
  cpu.cpu = "z80";
  EXPECT_NE(compile_kernel(program.split, cpu).error().find("known are x86-64-v2, x86-64-v3"),
            std::string::npos);
}

TEST(Options, Listings) {
  TestProgram program;
  emit_sum(program, 5);
  CodegenOptions options;
  options.cpu = "x86-64-v4-vbmi";  // also where this processor cannot run it
  const auto llvm = emit_listing(program.split, options, Listing::llvm);
  ASSERT_TRUE(llvm) << llvm.error();
  EXPECT_NE(llvm->find("fadd <32 x float>"), std::string::npos) << *llvm;
  const auto assembly = emit_listing(program.split, options, Listing::assembly);
  ASSERT_TRUE(assembly) << assembly.error();
  EXPECT_NE(assembly->find("zmm"), std::string::npos) << *assembly;
}

}  // namespace
}  // namespace pse::testing_support
