#!/bin/bash
# proxy.sh BINARY: two services behind HAProxy, as server/deploy/haproxy.cfg has them, on other ports. While four clients
# ask without a pause, each service in turn is told to end and begins again, and the proxy may not ask twice; then it may,
# and one ends while the other is killed: every request is answered, with the bytes that a service alone gives. Then: what
# streams comes through as it is made.
set -eu
export LC_ALL=C
here=$(dirname "$(readlink -f "$0")")
binary=$(readlink -f "$1")
work=$(mktemp -d /tmp/least-proxy.XXXXXX)
clean() {
  # shellcheck disable=SC2046  # a list
  { kill -9 $(jobs -p) || true; wait; } 2>/dev/null
  rm -rf "$work"
}
trap clean EXIT
trap 'exit 130' INT TERM
say() { echo "== $*"; }
die() {
  say "FAILED: $*" >&2
  tail -n 5 "$work"/*.log >&2
  exit 1
}
wait_for() { # SECONDS COMMAND…
  local end=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do
    [ $SECONDS -lt $end ] || return 1
    sleep 0.1
  done
}

cd "$work"
front=18480 one=18481 two=18482
sed "s/8080/$front/; s/8081/$one/; s/8082/$two/" "$here/../../server/deploy/haproxy.cfg" >haproxy.cfg
sed 's/retries 3/retries 0/; /redispatch/d; /retry-on/d' haproxy.cfg >once.cfg
serve() { # PORT: its process is in `pid`
  "$binary" serve --port "$1" --drain 2 --trusted-proxy 127.0.0.1 >>"$1.log" 2>&1 &
  pid=$!
  wait_for 10 curl -sf "http://127.0.0.1:$1/readyz" || die "no service on port $1"
}
answer() { # PORT: of a run, without its cost; no answer is no bytes
  curl -sf --max-time 30 "http://127.0.0.1:$1/v1/simulate" -d @request.json | sed 's/"cost":{[^}]*}//'
}
cat >request.json <<'END'
{"problem": "kepler", "scheme": {"id": "leapfrog", "step": 0.0001}, "until": {"t": 40}, "record": {"samples": 100}}
END

proxy() { # CONFIGURATION: its process is in `proxy`
  haproxy -f "$1" >>haproxy.log 2>&1 &
  proxy=$!
  wait_for 10 curl -sf "http://127.0.0.1:$front/readyz" || die "no answer through the proxy"
}

serve $one
first=$pid
serve $two
second=$pid
proxy once.cfg
answer $one >expected
[ "$(wc -c <expected)" -gt 1000 ] || die "no answer: $(cat expected)"

client() { # NUMBER: asks until it is told to stop
  local asked=0 wrong=0
  while [ ! -e stop ]; do
    answer $front >"answer.$1" || true
    cmp -s expected "answer.$1" || wrong=$((wrong + 1))
    asked=$((asked + 1))
  done
  echo "$asked $wrong" >"client.$1"
}
begin() {
  rm -f stop client.*
  clients=
  for number in 1 2 3 4; do
    client $number &
    clients="$clients $!"
  done
}
end() { # in `asked` and `wrong`
  touch stop
  # shellcheck disable=SC2086  # a list
  wait $clients
  totals=$(awk '{asked += $1; wrong += $2} END {print asked, wrong}' client.*)
  asked=${totals% *} wrong=${totals#* }
  [ "$asked" -ge 40 ] || die "only $asked requests were made"
}

begin
sleep 1
kill -TERM $first
wait $first || die "the first service ended with $?"
serve $one
first=$pid
sleep 1
kill -TERM $second
wait $second || die "the second service ended with $?"
serve $two
second=$pid
sleep 1
end
[ "$wrong" -eq 0 ] || die "$wrong of $asked requests were refused in a rollout"
say "$asked requests while each service ended and began again, none asked twice: none refused"
grep -q 'client=127.0.0.1' $one.log || die "the log has no client"
id=$(curl -s -D - -o answered -H 'X-Request-Id: rollout-7' "http://127.0.0.1:$front/v1" | tr -d '\r' | sed -n 's/^[Xx]-[Rr]equest-[Ii]d: //p')
[ "$id" = rollout-7 ] || die "the request is called $id"
id=$(curl -s -D - -o answered "http://127.0.0.1:$front/v1" | tr -d '\r' | sed -n 's/^[Xx]-[Rr]equest-[Ii]d: //p')
[ ${#id} -eq 36 ] || die "the proxy's name of a request is $id"
curl -s -o answered -H 'X-Forwarded-For: 6.6.6.6' "http://127.0.0.1:$front/v1"
sleep 0.5
! grep -q 'client=6.6.6.6' ./*.log || die "a client passed for another"
kill $proxy
wait $proxy 2>/dev/null || true
proxy haproxy.cfg

begin
sleep 1
kill -TERM $first
wait $first || die "the first service ended with $?"
sleep 1
serve $one
sleep 1
{ kill -9 $second; wait $second || true; } 2>/dev/null
sleep 1
end
[ "$wrong" -eq 0 ] || die "$wrong of $asked requests were not answered as by a service alone"
say "$asked requests through a proxy while one service ended and one was killed: all answered, with the same bytes"

cat >long.json <<'END'
{"problem": "kepler", "scheme": {"id": "leapfrog", "step": 0.0001}, "until": {"t": 10000}, "record": {"every": 10000}}
END
curl -sN --max-time 60 -H 'Accept: application/x-ndjson' -d @long.json -o lines.json \
  -w '%{time_starttransfer} %{time_total}\n' "http://127.0.0.1:$front/v1/simulate" >times
tail -n 1 lines.json | grep -q '"kind":"end"' || die "the stream has no end"
awk '{exit !($1 < $2 / 2)}' times || die "the stream was kept back: first byte and all after $(cat times) s"
say "a stream: first byte and all after $(cat times) s"
