#!/bin/bash
# run.sh BINARY: an ensemble as a job array of 16 on a real Slurm that this machine pretends to have nodes for. One of
# them is killed on the way, what it computed is queued again, and the parts merge to the bytes of a single run. Prints
# what the way through a cluster costs: the processor time of one run over that of all shards, and the wall time.
set -eu
export LC_ALL=C
here=$(dirname "$(readlink -f "$0")")
binary=$(readlink -f "$1")
shards=16
nodes=$(nproc)
[ "$nodes" -ge 2 ] || nodes=2
[ "$nodes" -le 4 ] || nodes=4  # each has several shards, one after the other
cluster=$(mktemp -d /tmp/least-slurm.XXXXXX)
chmod 711 "$cluster"
. "$here/slurm.bash"

say() { echo "== $*"; }
die() {
  say "FAILED: $*" >&2
  grep -hiE 'error|fatal' "$cluster"/*.log | grep -v /pmix | tail -n 20 >&2
  exit 1
}
clean() {
  cluster_down
  rm -rf "$cluster"
}
trap clean EXIT
trap 'exit 130' INT TERM

work=$cluster/work
mkdir "$work"
cp "$here/study.json" "$work"
cd "$work"

# The binary as jobs find it: it notes where it begins and, by the second line of `times`, what it cost.
cat >leastaction <<END
#!/bin/bash
echo "\${SLURM_ARRAY_TASK_ID:-} attempt \${SLURM_RESTART_COUNT:-0} on \${SLURMD_NODENAME:-}" >>$work/begun
"$binary" "\$@"
status=\$?
times >$work/times.\$\$
sed -n '2s/[ms]/ /gp' $work/times.\$\$ | awk '{print 60 * \$1 + \$2 + 60 * \$3 + \$4}' >>$work/core_seconds
exit \$status
END
chmod +x leastaction

without_cost() { sed 's/"cost":{[^}]*},//' "$1"; }
task_on() { squeue -h -r -t R -j "$job" -w "$1" -o %K; }
at_work() { [ -n "$(steps_of "$1")" ] && [ -n "$(task_on "$1")" ]; }
restarts() { scontrol -o show job "${job}_$1" 2>/dev/null | sed -n 's/.* Restarts=\([0-9]*\).*/\1/p'; }
was_requeued() { [ "$(restarts "$1")" = 1 ]; }
half_done() { [ "$(ls parts 2>/dev/null | wc -l)" -ge $((shards / 2)) ]; }
all_ended() { [ -z "$(squeue -h -r -j "$job" 2>/dev/null)" ]; }

say "one run, on one core"
./leastaction ensemble study.json --threads 1 --max-seconds 1e9 >one.json || die "the run: $(cat one.json)"
one=$(cat core_seconds)
rm core_seconds begun

say "a Slurm of $nodes nodes"
cluster_up "$nodes" || die "no cluster: $(cat "$cluster/start.log")"
sinfo --version
from=$(date +%s.%N)
job=$(LEASTACTION=$work/leastaction sbatch --parsable --array=0-$((shards - 1)) --output=log.%a \
  "$here/../../server/deploy/slurm.sbatch" study.json parts) || die "sbatch"
say "array $job of $shards shards"

wait_for 3600 half_done || die "no shards are computed: $(cat log.*)"
node=n$nodes
wait_for 60 at_work "$node" || die "nothing runs on node $node"
task=$(task_on "$node")
say "$(ls parts | wc -l) parts are there; node $node dies with task $task"
kill_node "$node"
wait_for 60 node_is "$node" down || die "node $node is not down"
wait_for 60 was_requeued "$task" || die "task $task is not queued again"
say "Slurm has queued task $task again; node $node comes back"
start_node "$node"
wait_for 3600 all_ended || die "the array does not end"
to=$(date +%s.%N)
grep ' attempt [1-9]' begun || die "nothing was begun a second time"

./leastaction merge parts/* >merged.json || die "merge: $(cat merged.json)"
[ -n "$(without_cost one.json)" ] && cmp <(without_cost one.json) <(without_cost merged.json) ||
  die "the parts do not merge to the bytes of one run"
say "the parts merge to the $(without_cost one.json | wc -c) bytes of one run"

# The last of the costs is that of the merge; of the task that was killed there is none.
awk -v one="$one" -v nodes="$nodes" -v wall="$(echo "$to $from" | awk '{print $1 - $2}')" '
  NR > 1 {sum += last} {last = $1}
  END {
    printf "== one run %.1f core-seconds, %d shards %.1f: efficiency %.3f; merge %.2f core-seconds\n", one, NR - 1, sum,
      one / sum, last
    printf "== %.1f s on the wall; %d nodes of a core compute for %.1f s, the rest goes into missing the one that died\n",
      wall, nodes, sum / nodes
  }' core_seconds
