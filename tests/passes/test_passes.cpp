// Each pass but the folder and the split, on modules small enough to know the answer.
#include "pass_test.h"

namespace pse::passes {
namespace {

using ir::Op;
using test::body_of;
using test::count;
using test::module_of;

TEST(RemoveDead, DropsWhatNobodyObserves) {
  auto module = module_of(R"(  array 0 "unread" 1 4 4 sample
  array 1 "read" 1 4 4 sample
  array 2 "measured" 1 4 4 sample
  %0 = input 0
  %1 = fsqrt %0
  %2 = const.i 1
  array.store 0.0 %2 %1
  array.store 1.0 %2 %0
  array.store 2.0 %2 %1
  array.resize 2 %2
  %3 = array.load 1.0 %2
  %4 = array.length 2
  %5 = i2f %4
  %6 = fadd %3 %5
  yield %6
)",
                          R"(function 0 "unused" {
  yield
}
)");
  remove_dead(module);
  EXPECT_EQ(module.functions.size(), 1u);
  EXPECT_EQ(module.entry, 0u);
  ASSERT_EQ(module.main().arrays.size(), 2u);
  EXPECT_EQ(module.main().arrays[0].name, "read");
  EXPECT_EQ(body_of(module.main()), R"(array 0 "read" 1 4 4 sample
array 1 "measured" 1 4 4 sample
%0 = input 0
%2 = const.i 1
array.store 0.0 %2 %0
array.resize 1 %2
%3 = array.load 0.0 %2
%4 = array.length 1
%5 = i2f %4
%6 = fadd %3 %5
yield %6
)");
}

TEST(RemoveDead, DropsWhatLoopsCarryForThemselvesAndWholeLoops) {
  auto module = module_of(R"(  %0 = input 0
  %1 = const.i 0
  %2 = const.i 1
  %10:i %11:f %12:f = loop %1 %0 %0 while (%20:i %21:f %22:f) {
    %3 = ilt %20 %2
    yield %3
  } do (%30:i %31:f %32:f) {
    %4 = iadd %30 %2
    %5 = fadd %31 %31
    %6 = fmul %32 %32
    yield %4 %5 %6
  }
  %13:i = loop %1 while (%40:i) {
    %7 = ilt %40 %2
    yield %7
  } do (%50:i) {
    %8 = iadd %50 %2
    yield %8
  }
  yield %11
)");
  remove_dead(module);
  EXPECT_EQ(count(module, Op::loop), 1u);
  EXPECT_EQ(count(module, Op::fmul), 0u);
  for (const ir::Instruction& in : module.main().body.body) {
    if (in.op == Op::loop) {  // the counter decides when it ends
      EXPECT_EQ(in.results.size(), 2u);
    }
  }
}

TEST(RemoveDead, KeepsEffectsAndTheIfsAroundThem) {
  auto module = module_of(R"(  %0 = input 0
  %1 = input 1
  %2 = flt %0 %1
  %5:f = if %2 {
    %3 = feq %0 %0
    check 0 %3
    yield %0
  } else {
    yield %1
  }
  yield %0
)");
  remove_dead(module);
  EXPECT_EQ(count(module, Op::check), 1u);
  EXPECT_EQ(count(module, Op::if_), 1u);
  EXPECT_TRUE(module.main().body.body.back().results.empty());
}

constexpr const char* two_functions = R"(function 0 "small" (%0:f) {
  %1 = fadd %0 %0
  yield %1
}
function 1 "calls" (%0:f) {
  %1:f = call 0 %0
  %2:f = call 0 %1
  yield %2
}
)";

TEST(Inline, SmallFunctionsDisappear) {
  auto module = module_of("  %0 = input 0\n  %1:f = call 1 %0\n  %2:f = call 1 %1\n  yield %2\n",
                          two_functions);
  inline_calls(module);
  EXPECT_EQ(count(module, Op::call), 0u);
  EXPECT_EQ(count(module, Op::fadd), 4u);
}

TEST(Inline, LargeFunctionsOnlyWhereCalledOnce) {
  const char* calls_twice = "  %0 = input 0\n  %1:f = call 0 %0\n  %2:f = call 0 %1\n  yield %2\n";
  const char* calls_once = "  %0 = input 0\n  %1:f = call 0 %0\n  yield %1\n";
  const std::string function(two_functions, std::string_view(two_functions).find("function 1"));
  auto twice = module_of(calls_twice, function);
  inline_calls(twice, {.small = 0});
  EXPECT_EQ(count(twice, Op::call), 2u);
  auto once = module_of(calls_once, function);
  inline_calls(once, {.small = 0});
  EXPECT_EQ(count(once, Op::call), 0u);
  auto bounded = module_of(calls_twice, function);
  inline_calls(bounded, {.max_total = 3});
  EXPECT_EQ(count(bounded, Op::call), 2u);
}

TEST(Share, ComputesOnce) {
  auto module = module_of(R"(  %0 = input 0
  %1 = input 1
  %2 = fadd %0 %1
  %3 = fadd %1 %0
  %4 = fsub %0 %1
  %5 = fsub %1 %0
  %6 = fmul %2 %3
  %7 = flt %4 %5
  %10:f = if %7 {
    %8 = fadd %0 %1
    %9 = fsqrt %0
    yield %8
  } else {
    %11 = fsqrt %0
    yield %11
  }
  %12 = fsqrt %0
  %13 = fadd %6 %10
  %14 = fadd %12 %13
  yield %14
)");
  share(module);
  EXPECT_EQ(count(module, Op::fadd), 3u);   // the sum of inputs once, and the last two
  EXPECT_EQ(count(module, Op::fsub), 2u);   // a difference does not commute
  EXPECT_EQ(count(module, Op::fsqrt), 3u);  // neither side's is visible elsewhere
}

TEST(Share, LoadsOnlyWhereNothingIsWrittenBetween) {
  const auto loads_left = [](const std::string& between) {
    auto module = module_of(
        "  array 0 \"a\" 1 4 4 sample\n  array 1 \"b\" 1 4 4 sample\n  %0 = input 0\n"
        "  %1 = const.i 1\n  %2 = const.b true\n  %3 = array.load 0.0 %1\n" +
        between + "  %4 = array.load 0.0 %1\n  %5 = fadd %3 %4\n  yield %5\n");
    share(module);
    return count(module, Op::array_load);
  };
  EXPECT_EQ(loads_left(""), 1u);
  EXPECT_EQ(loads_left("array.store 1.0 %1 %0\n"), 1u);
  EXPECT_EQ(loads_left("array.store 0.0 %1 %0\n"), 2u);
  EXPECT_EQ(loads_left("array.resize 0 %1\n"), 2u);
  EXPECT_EQ(loads_left("if %2 {\n array.store 0.0 %1 %0\n yield\n } else {\n yield\n }\n"), 2u);
  EXPECT_EQ(loads_left("if %2 {\n yield\n } else {\n yield\n }\n"), 1u);
  EXPECT_EQ(loads_left("loop while {\n yield %2\n } do {\n array.store 0.0 %1 %0\n yield\n }\n"),
            2u);
}

TEST(Share, ALoadInALoopSeesTheStoreBehindIt) {
  auto module = module_of(R"(  array 0 "a" 1 4 4 sample
  %0 = input 0
  %1 = const.i 1
  %2 = array.load 0.0 %1
  %3 = const.f 9
  %10:f = loop %2 while (%11:f) {
    %4 = array.load 0.0 %1
    %5 = flt %4 %3
    yield %5
  } do (%12:f) {
    %6 = array.load 0.0 %1
    %7 = fadd %6 %3
    array.store 0.0 %1 %7
    %8 = array.load 0.0 %1
    yield %8
  }
  %9 = array.load 0.0 %1
  %13 = fadd %9 %10
  yield %13
)");
  share(module);
  EXPECT_EQ(count(module, Op::array_load), 5u);
}

TEST(SimplifyLoops, ALoopThatNeverTurnsIsItsInitialValues) {
  const auto loops_left = [](const std::string& limit) {
    auto module = module_of("  %0 = input 0\n  %1 = const.i 0\n  %2 = " + limit + R"(
  %10:i %11:f = loop %1 %0 while (%20:i %21:f) {
    %3 = flt %21 %0
    %4 = ilt %20 %2
    %5 = band %3 %4
    yield %5
  } do (%30:i %31:f) {
    %6 = iadd %30 %2
    %7 = fsqrt %31
    yield %6 %7
  }
  yield %11
)");
    simplify_loops(module);
    EXPECT_TRUE(ir::verify(module).empty());
    if (count(module, Op::loop) == 0) {
      EXPECT_EQ(module.main().body.yields[0], 0u);
    }
    return count(module, Op::loop);
  };
  EXPECT_EQ(loops_left("const.i 0"), 0u);
  EXPECT_EQ(loops_left("const.i 1"), 1u);
  EXPECT_EQ(loops_left("f2i %0"), 1u);
}

TEST(SimplifyLoops, WhatIsNotChangedIsNotCarried) {
  auto module = module_of(R"(  %0 = input 0
  %1 = const.i 0
  %2 = const.i 5
  %10:i %11:f %12:f = loop %1 %0 %0 while (%20:i %21:f %22:f) {
    %3 = ilt %20 %2
    yield %3
  } do (%30:i %31:f %32:f) {
    %4 = iadd %30 %2
    %5 = fadd %31 %32
    yield %4 %5 %32
  }
  %13 = fadd %11 %12
  yield %13
)");
  simplify_loops(module);
  EXPECT_TRUE(ir::verify(module).empty());
  for (const ir::Instruction& in : module.main().body.body) {
    if (in.op == Op::loop) {
      EXPECT_EQ(in.results.size(), 2u);
    }
    if (in.op == Op::fadd) {
      EXPECT_EQ(in.operands[1], 0u);
    }
  }
}

TEST(Unroll, LoopsOfAKnownFewTurnsBecomeStraight) {
  const auto straight = [](const std::string& start, const std::string& limit,
                           const std::string& compare) {
    auto module = module_of("  %0 = input 0\n  %1 = const.i " + start + "\n  %2 = const.i " +
                            limit + R"(
  %3 = const.i 2
  %4 = const.f 1
  %10:i %11:f %12:f = loop %1 %4 %0 while (%20:i %21:f %22:f) {
    %5 = )" + compare + R"( %20 %2
    yield %5
  } do (%30:i %31:f %32:f) {
    %6 = iadd %30 %3
    %7 = fadd %31 %31
    %8 = fmul %32 %31
    yield %6 %7 %8
  }
  yield %12
)");
    unroll(module);
    EXPECT_TRUE(ir::verify(module).empty());
    return count(module, Op::loop) == 0 ? static_cast<int>(count(module, Op::fmul)) : -1;
  };
  EXPECT_EQ(straight("0", "4", "ilt"), 2);  // 0 2
  EXPECT_EQ(straight("0", "4", "ile"), 3);  // 0 2 4
  EXPECT_EQ(straight("0", "5", "ilt"), 3);  // 0 2 4
  EXPECT_EQ(straight("-3", "-3", "ile"), 1);
  EXPECT_EQ(straight("7", "7", "ilt"), 0);
  EXPECT_EQ(straight("0", "1000", "ilt"), -1);        // too long
  EXPECT_EQ(straight("0", "2147483647", "ile"), -1);  // would wrap
}

TEST(Decide, ClampedIndicesNeedNoCheck) {
  const auto checks_left = [](const std::string& index) {
    auto module = module_of(R"(  %0 = input 0
  %1 = const.f 0
  %2 = const.f 3
  %3 = const.i 0
  %4 = const.i 4
)" + index + R"(  %90 = ile %3 %80
  %91 = ilt %80 %4
  %92 = band %90 %91
  check 0 %92
  yield %0
)");
    decide(module);
    fold(module);
    return count(module, Op::check);
  };
  EXPECT_EQ(checks_left("%10 = fmax %0 %1\n %11 = fmin %10 %2\n %80 = f2i %11\n"), 0u);
  EXPECT_EQ(checks_left("%10 = fmin %0 %2\n %11 = fmax %10 %1\n %80 = f2i %11\n"), 0u);
  // NaN is the first of fmax, so it stays.
  EXPECT_EQ(checks_left("%10 = fmax %1 %0\n %11 = fmin %2 %10\n %80 = f2i %11\n"), 1u);
  EXPECT_EQ(checks_left("%10 = fmin %0 %2\n %80 = f2i %10\n"), 1u);
  EXPECT_EQ(
      checks_left("%10 = const.f 4\n %11 = fmax %0 %1\n %12 = fmin %11 %10\n %80 = f2i %12\n"), 1u);
  EXPECT_EQ(checks_left("%10 = f2i %0\n %11 = const.i 3\n %80 = iand %10 %11\n"), 0u);
  EXPECT_EQ(checks_left("%10 = f2i %0\n %11 = const.i 30\n %80 = ishr %10 %11\n"), 0u);
  EXPECT_EQ(checks_left("%10 = f2i %0\n %11 = const.i 29\n %80 = ishr %10 %11\n"), 1u);
}

TEST(Decide, CountersStayWithinTheirLimits) {
  auto module = module_of(R"(  %0 = input 0
  %1 = const.i 0
  %2 = const.i 1
  %3 = const.i 100
  %4 = const.i 99
  %10:i = loop %1 while (%20:i) {
    %5 = ilt %20 %3
    yield %5
  } do (%30:i) {
    %6 = ile %30 %4
    check 0 %6
    %7 = ile %1 %30
    check 0 %7
    %8 = ilt %30 %4
    check 0 %8
    %9 = iadd %30 %2
    yield %9
  }
  %11 = ile %10 %3
  check 0 %11
  yield %0
)");
  decide(module);
  fold(module);
  EXPECT_EQ(count(module, Op::check), 1u);  // the one that fails in the last turn
}

TEST(ConvertIfs, SmallOnesBecomeSelectsAndOthersStay) {
  const auto ifs_left = [](const std::string& work) {
    auto module = module_of(
        "  array 0 \"a\" 1 4 4 sample\n  %0 = input 0\n  %1 = input 1\n  %2 = flt %0 %1\n"
        "  %9 = const.i 1\n %3:f = if %2 {\n" +
        work +
        "  yield %4\n  } else {\n  yield %1\n  }\n"
        "  yield %3\n");
    convert_ifs(module);
    EXPECT_TRUE(ir::verify(module).empty());
    EXPECT_EQ(count(module, Op::select), 1 - count(module, Op::if_));
    return count(module, Op::if_);
  };
  EXPECT_EQ(ifs_left("%4 = fneg %0\n"), 0u);
  EXPECT_EQ(ifs_left("%4 = array.load 0.0 %9\n"), 0u);
  EXPECT_EQ(ifs_left("%4 = fneg %0\n check 0 %2\n"), 1u);
  EXPECT_EQ(ifs_left("%4 = fneg %0\n array.store 0.0 %9 %4\n"), 1u);
  EXPECT_EQ(ifs_left("%4:f = external 0 %0\n"), 1u);
  std::string much;
  for (int i = 10; i < 60; ++i) much += "%" + std::to_string(i) + " = fneg %0\n";
  EXPECT_EQ(ifs_left(much + "%4 = fneg %0\n"), 1u);
}

TEST(Hoist, InvariantsLeaveAllLoopsButDearOnesStay) {
  auto module = module_of(R"(  %0 = input 0
  %1 = const.i 0
  %10:i = loop %1 while (%20:i) {
    %2 = f2i %0
    %3 = ilt %20 %2
    yield %3
  } do (%30:i) {
    %4 = flt %0 %0
    %11:i = loop %30 while (%40:i) {
      %5 = ilt %40 %30
      yield %5
    } do (%50:i) {
      %6 = fsqrt %0
      %12:f = if %4 {
        %7 = fdiv %6 %0
        %8:f = external 0 %0
        %9 = fadd %7 %8
        yield %9
      } else {
        yield %6
      }
      %13 = f2i %12
      %14 = iadd %50 %13
      yield %14
    }
    %15 = iadd %30 %11
    yield %15
  }
  %16 = i2f %10
  yield %16
)");
  hoist(module);
  EXPECT_TRUE(ir::verify(module).empty());
  std::size_t outside = 0;
  bool external_outside = false;
  for (const ir::Instruction& in : module.main().body.body) {
    outside += in.op == Op::fsqrt || in.op == Op::fdiv || in.op == Op::flt || in.op == Op::f2i;
    external_outside = external_outside || in.op == Op::external;
  }
  EXPECT_EQ(outside, 4u);
  EXPECT_FALSE(external_outside);
}

TEST(Hoist, OutOfAnIfOnlyWithALoopOnTheWay) {
  auto module = module_of(R"(  %0 = input 0
  %1 = flt %0 %0
  %3:f = if %1 {
    %2 = fsqrt %0
    yield %2
  } else {
    yield %0
  }
  yield %3
)");
  hoist(module);
  for (const ir::Instruction& in : module.main().body.body) EXPECT_NE(in.op, Op::fsqrt);
}

TEST(CompactValues, NumbersWithoutGaps) {
  auto module = module_of("  %7 = input 0\n  %900 = fneg %7\n  yield %900\n");
  compact_values(module);
  EXPECT_EQ(module.main().values.size(), 2u);
  EXPECT_EQ(body_of(module.main()), "%0 = input 0\n%1 = fneg %0\nyield %1\n");
}

}  // namespace
}  // namespace pse::passes
