#include "core/ensemble/members_at_poles.hpp"

#include <algorithm>
#include <cmath>

#include "core/ensemble/member_starts.hpp"
#include "core/run/backend.hpp"
#include "core/run/damping_pole.hpp"
#include "core/run/save_schedule.hpp"
#include "core/tape/derivative.hpp"
#include "core/text/scene.hpp"

namespace least {
namespace {

bool damping_varies(const text::Form& form, const Members& members) {
  tape::Dependences depends(form.tape, [&](int variable) -> tape::Dependence {
    return std::ranges::any_of(members.vary, [&](const Variation& varied) {
      return varied.is_parameter() && variable == form.numbers.parameter + static_cast<int>(varied.index);
    });
  });
  return (depends(form.damping) & 1) != 0;
}

}  // namespace

bool any_meets_pole(const EnsemblePlan& plan, const Block& block) {
  const text::TextScene* const text = plan.request.scene->mechanics->text();
  if (!text || text->form->kind != text::FormKind::contact_linear || text->form->constant_damping) return false;
  const SchemeCard& scheme = plan.request.scene->mechanics->schemes()[plan.request.scheme];
  const Grid grid(plan.request, plan.request.settings[*scheme.find("step")]);
  const MemberStarts starts(plan);
  const std::int64_t looks = damping_varies(*text->form, plan.members) ? block.count : 1;
  Request request = plan.request;
  for (std::int64_t i = block.first; i < block.first + looks; ++i) {
    request.scene = starts.scene(i);
    if (text->objection(request.scene->parameters)) continue;  // no run begins with these parameters
    const auto backend = request.scene->mechanics->backend(request);
    if (std::isfinite(damping_pole(backend->motion(), grid.start, grid.end))) return true;
  }
  return false;
}

}  // namespace least
