// Scenes as text that are short, but whose derived formulas are large: nested squares, towers of exponentials, products
// of sums, each as a potential, a Lagrangian, a Hamiltonian and as equations; and scenes of many variables, whose
// tangents have as many numbers as variables squared.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace least::server::test {

struct Explosive {
  std::string name, problem;  ///< the member of a request
};

class ExplosiveTexts {
 public:
  using Letters = std::vector<std::string>;

  static std::vector<Explosive> all() {
    ExplosiveTexts texts;
    std::vector<Explosive> made;
    for (std::size_t shape = 0; shape < shapes.size(); ++shape)
      for (const char* kind : {"potential", "lagrangian", "hamiltonian", "equations"})
        made.push_back({std::string(shapes[shape]) + ' ' + kind, texts.problem(shape, kind)});
    return made;
  }

 private:
  static constexpr std::array<const char*, 10> shapes{"nested squares",
                                                      "sums of nested squares",
                                                      "towers",
                                                      "one tower",
                                                      "products of sums",
                                                      "sums of products",
                                                      "flat",
                                                      "trees",
                                                      "sines",
                                                      "nested quotients"};
  static constexpr std::size_t most = 8000;  ///< characters

  std::string problem(std::size_t shape, const std::string& kind) {
    const Letters eight{"a", "b", "c", "d", "f", "g", "k", "m"};
    Letters letters = eight;
    std::string squares;
    for (const std::string& x : eight)
      squares += (squares.empty() ? "" : "+") + (kind == "lagrangian" ? "v" + x : "p" + x) + "^2";
    std::string mechanics;
    if (kind == "potential") mechanics = text(shape, letters);
    if (kind == "lagrangian") mechanics = "(" + squares + ")/2*(1+.01*a^2)-(" + text(shape, letters) + ")";
    if (kind == "hamiltonian") {
      Letters both{"a", "b", "c", "d", "pa", "pb", "pc", "pd"};
      mechanics = "(" + squares + ")/2+" + text(shape, both);
    }
    if (kind == "equations") {
      for (const char* x : {"n", "o", "r", "u", "w", "y", "z", "x"}) letters.emplace_back(x);
      mechanics = "{";
      for (std::size_t i = 0; i < letters.size(); ++i)
        mechanics += (i > 0 ? ",\"" : "\"") + letters[i] + "\":\"" +
                     (i == 0 ? text(shape, letters) : "-" + letters[(i + 1) % letters.size()]) + '"';
      mechanics += "}";
    } else {
      mechanics = '"' + mechanics + '"';
    }
    std::string names;
    for (const std::string& x : letters) names += (names.empty() ? "\"" : ",\"") + x + '"';
    return R"("problem":{"id":"custom","variables":[)" + names + "],\"" + kind + "\":" + mechanics + "}";
  }

  /// joined() joins as many terms with a sign between as there is room for.
  std::string joined(char sign, const std::function<std::string(std::size_t)>& term) const {
    std::string all = term(0);
    for (std::size_t i = 1; i < 400; ++i) {
      const std::string next = term(i);
      if (all.size() + next.size() > most) break;
      all += sign + next;
    }
    return all;
  }
  static std::string nested(std::size_t depth, const std::string& x,
                            const std::function<std::string(std::string, std::size_t)>& around) {
    std::string text = x;
    for (std::size_t i = 0; i < depth; ++i) text = around(text, i);
    return text;
  }

  std::string text(std::size_t shape, const Letters& x) {
    const auto letter = [&](std::size_t i) { return x[i % x.size()]; };
    const auto any = [&] { return x[random_() % x.size()]; };
    switch (shape) {
      case 0:
        return nested(90, letter(0),
                      [&](const std::string& of, std::size_t i) { return "(" + of + "+.1*" + letter(i) + ")^2"; });
      case 1:
        return joined('+', [&](std::size_t k) {
          return nested(12, letter(k),
                        [&](const std::string& of, std::size_t i) { return "(" + of + "-" + letter(i + k) + ")^2"; });
        });
      case 2:
        return joined('+', [&](std::size_t k) {
          return nested(8, letter(k), [&](const std::string& of, std::size_t i) {
            return "exp(-" + of + "*" + letter(i + k + 1) + ")";
          });
        });
      case 3:
        return nested(45, letter(0),
                      [&](const std::string& of, std::size_t i) { return "exp(-(" + of + ")*" + letter(i) + ")"; });
      case 4:
        return joined('*', [&](std::size_t) {
          std::string sum = "(1";
          for (const std::string& name : x) sum += (random_() % 2 ? "+" : "-") + name;
          return sum + ")";
        });
      case 5:
        return joined('+', [&](std::size_t) {
          std::string product = any();
          for (int i = 0; i < 7; ++i) product += "*" + any();
          return product;
        });
      case 6: {
        std::string all = letter(0);
        while (all.size() < most - 500) all += (random_() % 2 ? "+" : "*") + any();
        return all;
      }
      case 7: {
        const std::function<std::string(int)> tree = [&](int depth) -> std::string {
          if (depth == 0) return any();
          const std::string left = tree(depth - 1);
          return "(" + left + (random_() % 2 ? "+" : "*") + tree(depth - 1) + ")";
        };
        return tree(10);
      }
      case 8:
        return joined(
            '+', [&](std::size_t k) { return "sin(" + std::to_string(k) + "*" + any() + "+" + any() + ")*" + any(); });
      default:
        return nested(45, letter(0),
                      [&](const std::string& of, std::size_t i) { return letter(i) + "/(1+(" + of + ")^2)"; });
    }
  }

  std::minstd_rand random_{7};
};

// wide_scenes() returns scenes of many variables, written as sums over them.
inline std::vector<Explosive> wide_scenes() {
  struct Shape {
    const char *name, *variables, *mechanics;
  };
  constexpr Shape shapes[] = {
      {"pairs of exponentials", R"~("q[50]")~", R"~("potential":"sum(i=1..50,j=1..50,exp(-(q[i]-q[j])^2-.01*q[i]))")~"},
      {"products of coordinates", R"~("q[45]")~", R"~("hamiltonian":
         "sum(i=1..45,p[i]^2/2)+sum(i=1..45,j=1..45,exp(.1*q[i]*q[j]-.1))")~"},
      {"rates of exponentials", R"~("q[50]")~", R"~("equations":{"q[i]":"sum(j=1..50,exp(-(q[i]-q[j])^2)-1)"})~"},
      {"pairs of kinks", R"~("q[50]")~", R"~("potential":"sum(i=1..50,j=i+1..50,abs(q[i]-q[j]-.01*i))")~"},
      {"a cluster of bodies", R"~("q[500]","y[500]")~",
       R"~("potential":"-sum(i=1..500,j=i+1..500,1/sqrt((q[i]-q[j]+i-j)^2+(y[i]-y[j])^2+.1))")~"},
      {"a crowd of oscillators", R"~("q[350]")~",
       R"~("equations":{"q[i]":"sum(j=1..350,sin(q[j]-q[i]+.01*i*j)*exp(-(q[i]-q[j])^2))"})~"},
      {"a chain", R"~("q[1024]")~", R"~("potential":"sum(i=1..1023,exp(q[i]-q[i+1]))+q[1]^2")~"},
      {"a chain of a Lagrangian", R"~("q[1024]")~", R"~("lagrangian":
         "sum(i=1..1024,v[i]^2/2)-sum(i=1..1023,exp(q[i]-q[i+1]))")~"},
      {"a chain of coupled momenta", R"~("q[1024]")~", R"~("hamiltonian":
         "sum(i=1..1023,p[i]*p[i+1]+(q[i+1]-q[i])^4/4)+sum(i=1..1024,p[i]^2)")~"},
      {"a chain of masses that move", R"~("q[1024]")~", R"~("lagrangian":
         "sum(i=1..1024,v[i]^2/2*(1+.1*q[i]^2))-sum(i=1..1023,exp(q[i]-q[i+1]))")~"},
      {"all velocities coupled", R"~("q[1024]")~", R"~("lagrangian":
         "sum(i=1..1024,v[i]^2/2)+.0001*sum(i=1..1024,v[i])^2-sum(i=1..1023,exp(q[i]-q[i+1]))")~"},
      {"all momenta coupled at a place", R"~("q[1024]")~", R"~("hamiltonian":
         "(1+q[1]^2)*sum(i=1..1024,p[i])^2/2+sum(i=1..1023,exp(q[i]-q[i+1]))")~"},
      {"velocities coupled in a field", R"~("q[1024]")~", R"~("lagrangian":
         "sum(i=1..1024,v[i]^2/2)+sum(i=1..1023,.1*v[i]*v[i+1]+v[i]*q[i+1])")~"},
      {"a damped chain", R"~("q[1024]")~",
       R"~("damping":0.1,"potential":"sum(i=1..1023,(q[i+1]-q[i])^2/2)+sum(i=1..1024,sin(q[i]))")~"},
      {"a ring of equations", R"~("q[2048]")~", R"~("equations":{"q[i]":"1-exp(q[i]-q[mod(i,2048)+1])"})~"},
      {"masses that move", R"~("q[8]")~",
       R"~("lagrangian":"sum(i=1..8,v[i]^2*(1+.1*q[i]^2)/2))~"
       R"~(+.01*sum(i=1..8,j=1..8,v[i]*v[j]*cos(q[i]-q[j]))-sum(i=1..8,q[i]^2)")~"},
      {"pairs that switch", R"~("q[24]")~",
       R"~("potential":"sum(i=1..24,q[i]^2)+sum(i=1..24,j=1..24,)~"
       R"~(if(q[i]<q[mod(i*j,24)+1],max(q[i],.1)^3,min(q[i],abs(q[mod(i+j,24)+1]))))")~"},
      {"all coordinates multiplied", R"~("q[1024]")~", R"~("potential":
         "prod(i=1..1024,1+.01*q[i]^2)*sum(i=1..1024,exp(.01*q[i]*q[mod(i,1024)+1]))")~"},
      {"a ring that switches", R"~("q[1024]")~", R"~("potential":
         "sum(i=1..1024,if(q[i]<q[mod(i,1024)+1],max(q[i],.1)^3,min(q[i],abs(q[mod(i+1,1024)+1]))))")~"},
      {"masses that all coordinates move", R"~("q[24]")~",
       R"~("lagrangian":"sum(i=1..24,v[i]^2/2)+)~"
       R"~(.001*sum(i=1..24,j=1..24,v[i]*v[mod(i*j,24)+1]*cos(q[i]*q[mod(i+j,24)+1]))")~"},
      {"bodies", R"~("x[40]","q[40]")~", R"~("potential":
         "sum(i=1..40,j=i+1..40,-1/sqrt((x[i]-x[j]+i-j)^2+(q[i]-q[j])^2+.1))")~"}};
  std::vector<Explosive> made;
  for (const Shape& shape : shapes)
    made.push_back({shape.name, std::string(R"("problem":{"id":"custom","variables":[)") + shape.variables + "]," +
                                    shape.mechanics + "}"});
  return made;
}

struct Question {
  std::string path, body;
};

// questions() returns every kind of request that derives formulas from a scene; `first` is one of the scene's
// variables.
inline std::vector<Question> questions(const Explosive& scene, const std::string& seconds,
                                       const std::string& first = "a") {
  const std::string begin = "{" + scene.problem, until = R"(,"until":{"t":1})",
                    limits = R"(,"limits":{"seconds":)" + seconds + "}}";
  const auto run = [&](const std::string& scheme) {
    return Question{"/v1/simulate", begin + R"(,"scheme":)" + scheme + until + limits};
  };
  return {run(R"({"id":"auto","accuracy":1e-6})"),
          run(R"("taylor")"),
          run(R"("leapfrog")"),
          {"/v1/work-precision", begin + until + R"(,"schemes":"all","budget_seconds":)" + seconds + "}"},
          {"/v1/stability", begin + R"(,"schemes":["runge_kutta_4","taylor"],"budget_seconds":)" + seconds + "}"},
          {"/v1/ensemble", begin + R"(,"scheme":"runge_kutta_4","members":{"count":100,"vary":
              {"/initial/)" + first +
                               R"(":{"uniform":[-0.1,0.1]}}})" + until + limits},
          {"/v1/problems", begin + "}"},
          run(R"("taylor","diagnostics":["lyapunov"])"),
          run(R"("taylor","diagnostics":["error"])"),
          run(R"("taylor","sensitivities":{"by":["/initial/)" + first + R"("]})"),
          run(R"("runge_kutta_4","sensitivities":{"by":["/initial/)" + first + R"("],"order":2})"),
          run(R"("taylor","record":{"every":0},"events":[{"name":"zero","expression":"sin()" + first +
              R"~()","direction":"both","stop":false}])~"),
          {"/v1/periodic", begin + R"(,"period":6,"initial":{")" + first + R"(":0.1})" + limits}};
}

// questions_of_structure() returns requests by schemes whose steps have derivatives, with the diagnostic that needs
// these.
inline std::vector<Question> questions_of_structure(const Explosive& scene, const std::string& seconds) {
  std::vector<Question> all;
  for (const char* scheme : {"variational_midpoint", "galerkin_4", "contact_gauss", "energy_momentum"})
    all.push_back({"/v1/simulate", "{" + scene.problem + R"(,"until":{"t":1},"diagnostics":["structure"],"scheme":")" +
                                       scheme + R"(","limits":{"seconds":)" + seconds + "}}"});
  return all;
}

}  // namespace least::server::test
