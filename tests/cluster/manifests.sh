#!/bin/bash
# manifests.sh: what server/deploy tells Kubernetes and Prometheus, held against their own descriptions of it, strictly: a
# member of no known name is a fault. The schemas of Kubernetes come with a package of Python's, promtool with Debian's of
# Prometheus, which is unpacked and not installed: as a service it would listen from the next start of the machine on. What
# cannot be had is left out with a word.
set -eu
cd "$(dirname "$(readlink -f "$0")")/../.."
say() { echo "== $*"; }
die() {
  say "FAILED: $*" >&2
  exit 1
}
work=$(mktemp -d /tmp/least-manifests.XXXXXX)
trap 'rm -rf "$work"' EXIT
deploy=server/deploy
mkdir -p build

# takes COMMAND FILE: what it says is in $work/said.
takes() { $1 "$deploy/$2" >"$work/said" 2>&1 || die "$2: $(cat "$work/said")"; }
# finds COMMAND FILE FROM TO: that a word of the file is misspelt; what finds nothing has looked at nothing.
finds() {
  sed "s/$3/$4/" "$deploy/$2" >"$work/$2"
  ! cmp -s "$deploy/$2" "$work/$2" || die "$2 has no $3"
  if $1 "$work/$2" >"$work/said" 2>&1; then die "$2 is taken with $4 in the place of $3"; fi
  grep -qF "$4" "$work/said" || die "$2 with $4 in the place of $3 is refused for something else: $(cat "$work/said")"
}

validator=build/kubernetes-validate
if ! python3 -c 'import ensurepip, venv' 2>/dev/null; then
  say "no python3 with venv: kubernetes.yaml is left out"
elif ! [ -x $validator/bin/kubernetes-validate ] &&
  ! { python3 -m venv $validator && $validator/bin/pip install -q kubernetes-validate==1.37.0; } >build/pip.log 2>&1; then
  cat build/pip.log >&2
  die "kubernetes-validate cannot be installed"
else
  # The first version that has all of it without being told to, and the newest that is known.
  for version in 1.29 1.37; do
    validate="$validator/bin/kubernetes-validate --strict -k $version"
    takes "$validate" kubernetes.yaml
    manifests=$(grep -c 'passed for' "$work/said")
    [ "$manifests" = "$(grep -c '^kind:' $deploy/kubernetes.yaml)" ] || die "not every manifest is read: $(cat "$work/said")"
    finds "$validate" kubernetes.yaml readinessProbe readynessProbe
    finds "$validate" kubernetes.yaml backoffLimitPerIndex backofLimitPerIndex
    say "kubernetes.yaml: $manifests manifests are what Kubernetes $version takes, and none with a misspelt member"
  done
fi

if ! command -v promtool >/dev/null && ! [ -x build/prometheus/usr/bin/promtool ] && command -v apt-get >/dev/null; then
  (cd build && apt-get download -q prometheus && dpkg-deb -x prometheus_*.deb prometheus) >build/prometheus.log 2>&1 || true
  rm -f build/prometheus_*.deb
fi
PATH=$PATH:$PWD/build/prometheus/usr/bin
if ! command -v promtool >/dev/null; then
  say "no promtool: alerts.yaml is left out"
else
  takes 'promtool check rules' alerts.yaml
  rules=$(sed -n 's/.*SUCCESS: //p' "$work/said")
  finds 'promtool check rules' alerts.yaml annotations anotations
  finds 'promtool check rules' alerts.yaml histogram_quantile histogram_quantil
  say "alerts.yaml: $rules, and with a misspelt word it is refused"
fi
