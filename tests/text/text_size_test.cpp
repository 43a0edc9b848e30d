// The size of a text that is written out, foreseen by arithmetic, against the text itself.
#include "core/text/text_size.hpp"

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "core/number/asked_by_thread.hpp"
#include "core/text/expansion.hpp"
#include "core/text/text_work.hpp"

namespace text_size {
namespace {

using namespace least;
using text::Expansion;
using text::Vocabulary;

Vocabulary words() {
  Vocabulary made;
  made.lists = {{"x", 400}, {"m", 400}};
  made.constants = {{"n", 40}, {"k", 2}};
  const auto define = [&](const char* name, std::vector<std::string> indices, const char* text) {
    std::size_t place = 0;
    made.definitions.push_back({name, std::move(indices), text, text::size_of(text, made, {}, false, place)});
  };
  define("r", {}, "sqrt(x[1]^2+x[2]^2)");
  define("d", {"i", "j"}, "(x[i]-x[j])");
  define("w", {"i"}, "sum(j=1..n, if(i != j, m[j]/d(i,j), 0))");
  return made;
}
text::TextSize size(const std::string& typed) {
  std::size_t place = 0;
  return text::size_of(typed, words(), {}, false, place);
}

TEST(TextSize, IsNeverMoreThanWhatIsWritten) {
  for (const char* typed :
       {"1.5e3*x[2] - y_1^2 + 2e-4", "sum(i=1..300, m[i])", "prod(i = k .. n-1, x[ n - i ])", "r+d(1,n)*r",
        "sum(i=1..k,j=i+1..k+1,i*j)", "sum(i=2..1,x[i])*prod(i=2..1,x[i])", "sum(i=-1..0,i^2)",
        "if(k<n and not (k==1 or n<=3),x[1],x[2]*x[3]*r)", "if(x[k]<1 and k<n,x[k],1)", "sum(i=1..n, w(i))",
        "sum(i=1..n, sum(j=i..n, x[j])*x[i])", "sum(i=1..n, j=i+1..n, w(i)*w(j))", "mod(1, 2)", "sum(i=1..k,"}) {
    const auto made = Expansion::of(typed, words());
    if (const auto* expansion = std::get_if<Expansion>(&made)) {
      EXPECT_LE(size(typed).characters, expansion->text().size()) << typed;
    }
  }
}

TEST(TextSize, CountsTermsWithoutWritingThem) {
  EXPECT_EQ(size("sum(i=1..300, m[i])").terms, 300U);
  EXPECT_EQ(size("sum(i=1..300, j=1..200, m[i])").terms, 60'000U);
  EXPECT_EQ(size("sum(i=1..300, j=i+1..300, m[i])").terms, 44'850U);
  EXPECT_EQ(size("sum(i=1..n, w(i))").terms, 1600U);
  EXPECT_GT(size("sum(i=1..1000000000, j=i+1..i, m[1])").terms, text::most_terms_of_text);
  EXPECT_GT(size("sum(i=1..1000000000, j=1..1000000000, k=1..1000000000, m[1])").terms, text::most_terms_of_text);
  EXPECT_GE(size("sum(i=1..300, m[i])").characters, 300 * std::string("(m[1])").size());
}

TEST(TextSize, SaysWhereATextBecomesTooLarge) {
  std::size_t place = 0;
  text::size_of("x[1]+sum(i=1..300,x[i])+sum(i=1..1000000,1)+r", words(), {}, false, place);
  EXPECT_EQ(place, 24U);
}

// The texts of one request share a bound, and end where nobody waits for them.
TEST(TextWork, IsThatOfAllTextsTogether) {
  const std::string typed = "sum(i=1..200, j=1..250, if(i < j + 500, x[i], 0))";
  const auto is_written = [&] { return std::holds_alternative<Expansion>(Expansion::of(typed, words())); };
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(is_written()) << "of each alone";
  const text::TextWork work;
  EXPECT_TRUE(is_written());
  EXPECT_FALSE(is_written());
}

TEST(TextWork, EndsWhereItIsNotWanted) {
  const std::string typed = "sum(i=1..200, j=1..250, if(i < j + 500, x[i], 0))";
  int questions = 0;
  {
    const AskedByThread asked([&] { return ++questions > 0; });
    EXPECT_TRUE(std::holds_alternative<Expansion>(Expansion::of(typed, words())));
  }
  EXPECT_GT(questions, 10);
  questions = 0;
  const AskedByThread asked([&] { return ++questions < 2; });
  EXPECT_TRUE(std::holds_alternative<Expansion::Wrong>(Expansion::of(typed, words())));
  EXPECT_EQ(questions, 2);
}

}  // namespace
}  // namespace text_size
