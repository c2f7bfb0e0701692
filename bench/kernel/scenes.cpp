// Written straight into IR with the templates of noise/.
#include "scenes.h"

#include <cmath>

#include "lower/ir_value.h"
#include "noise/improved.h"
#include "noise/power.h"

namespace pse::bench {
namespace {

struct Writer {
  Scene scene;
  ir::Builder build;
  std::array<IrFloat, 3> point;

  explicit Writer(const std::string& name, double noises)
      : scene{name, {}, noises, {}}, build{prepare(scene), scene.split.module.functions[0]} {
    for (std::size_t i = 0; i < 3; ++i) {
      scene.split.module.inputs.push_back(
          {std::string("point.") + std::to_string(i), ir::Rate::sample});
      point[i] = IrFloat(build, build.emit(ir::Op::input, {}, static_cast<std::int32_t>(i)));
    }
    scene.split.first_slot = 3;
  }

  static ir::Module& prepare(Scene& scene) {
    scene.split.module.functions.resize(2);
    scene.split.frame = 1;
    return scene.split.module;
  }

  void output(const IrFloat& value) {
    scene.split.module.outputs.push_back({"out"});
    scene.split.module.functions[0].body.yields.push_back(place(build, value));
  }
};

// sum over k < octaves of 2^-k f(Noise(2^k P)) as a loop.
template <class F>
IrFloat octaves(Writer& w, int count, const F& f) {
  ir::Builder& b = w.build;
  ir::Region head, body;
  b.begin_region(head);
  const ir::Value k = b.add_param(head, ir::Type::i32);
  for (int i = 0; i < 2; ++i) b.add_param(head, ir::Type::f32);
  head.yields = {b.emit(ir::Op::ilt, {k, b.const_i32(count)})};
  b.end_region();
  b.begin_region(body);
  const ir::Value n = b.add_param(body, ir::Type::i32);
  const IrFloat frequency(b, b.add_param(body, ir::Type::f32)),
      sum(b, b.add_param(body, ir::Type::f32));
  const IrFloat value = num::improved_noise<IrFloat, 3>(
      {w.point[0] * frequency, w.point[1] * frequency, w.point[2] * frequency});
  const IrFloat next = sum + f(value) / frequency;
  body.yields = {b.emit(ir::Op::iadd, {n, b.const_i32(1)}), (frequency * IrFloat(2.0f)).value,
                 next.value};
  b.end_region();
  const ir::Value initial[] = {b.const_i32(0), b.const_f32(1), b.const_f32(0)};
  return {b, b.emit_loop(initial, std::move(head), std::move(body))[2]};
}

template <class F>
IrFloat octaves_unrolled(Writer& w, int count, const F& f) {
  IrFloat sum(0.0f);
  float frequency = 1;
  for (int k = 0; k < count; ++k, frequency *= 2) {
    const IrFloat scale(frequency);
    const IrFloat value = f(num::improved_noise<IrFloat, 3>(
                              {w.point[0] * scale, w.point[1] * scale, w.point[2] * scale})) *
                          IrFloat(1 / frequency);
    sum = k == 0 ? value : sum + value;
  }
  return sum;
}

template <class F>
float sum_of_octaves(int count, float x, float y, float z, const F& f) {
  float sum = 0, frequency = 1;
  for (int k = 0; k < count; ++k, frequency *= 2) {
    sum +=
        f(num::improved_noise<float, 3>({x * frequency, y * frequency, z * frequency})) / frequency;
  }
  return sum;
}

const auto plain = [](auto v) { return v; };
const auto absolute = [](auto v) {
  using std::abs;
  return abs(v);
};

Scene noise() {
  Writer w("noise 3-D", 1);
  w.output(num::improved_noise<IrFloat, 3>(w.point));
  w.scene.expected = [](float x, float y, float z) {
    return num::improved_noise<float, 3>({x, y, z});
  };
  return std::move(w.scene);
}

Scene gradient_noise() {
  Writer w("Dnoise 3-D", 1);
  using D = num::Dual<IrFloat, 3>;
  std::array<D, 3> p;
  for (std::size_t i = 0; i < 3; ++i) p[i] = D::variable(w.point[i], i);
  const D result = num::improved_noise<D, 3>(p);
  for (std::size_t i = 0; i < 3; ++i) w.output(*result.slope[i]);
  w.scene.expected = [](float x, float y, float z) {
    using C = num::Dual<float, 3>;
    return num::improved_noise<C, 3>({C::variable(x, 0), C::variable(y, 1), C::variable(z, 2)})
        .slope[0]
        .value();
  };
  return std::move(w.scene);
}

// |x| to a power that varies, and to one that does not: what shading and marching spend beside
// noise.
Scene power(bool varies) {
  Writer w(varies ? "|x| ^ y" : "|x| ^ 5.5", 1);
  const auto exponent = [varies](auto y) { return varies ? y : decltype(y)(5.5f); };
  w.output(num::pow(absolute(w.point[0]) * IrFloat(0.125f), exponent(w.point[1])));
  w.scene.expected = [exponent](float x, float y, float) {
    return num::pow(absolute(x) * 0.125f, exponent(y));
  };
  return std::move(w.scene);
}

template <class F>
Scene octave_scene(const std::string& name, int count, bool unrolled, const F& f) {
  Writer w(name, count);
  w.output(unrolled ? octaves_unrolled(w, count, f) : octaves(w, count, f));
  w.scene.expected = [count, f](float x, float y, float z) {
    return sum_of_octaves(count, x, y, z, f);
  };
  return std::move(w.scene);
}

}  // namespace

std::vector<Scene> noise_scenes() {
  std::vector<Scene> scenes;
  scenes.push_back(noise());
  scenes.push_back(gradient_noise());
  scenes.push_back(power(true));
  scenes.push_back(power(false));
  scenes.push_back(octave_scene("turbulence, 6 octaves, loop", 6, false, absolute));
  scenes.push_back(octave_scene("turbulence, 6 octaves, unrolled", 6, true, absolute));
  scenes.push_back(octave_scene("fbm8, loop", 8, false, plain));
  scenes.push_back(octave_scene("fbm8, unrolled", 8, true, plain));
  return scenes;
}

}  // namespace pse::bench
