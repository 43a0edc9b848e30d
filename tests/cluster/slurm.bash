# A throw-away Slurm on this machine: several nodes on loopback, no systemd, no cgroups. To be sourced; it is in
# $cluster, a folder of a short name (sockets have names of at most 107 characters), and nothing of it outlives that.

PATH=$PATH:/usr/sbin:/sbin
export SLURM_CONF=$cluster/slurm.conf
# What is set for another cluster, or by a job of one, must not leak into this one.
unset SLURM_CLUSTERS SLURM_JWT SBATCH_CLUSTERS SBATCH_PARTITION SBATCH_ACCOUNT SBATCH_QOS SBATCH_RESERVATION

# wait_for SECONDS COMMAND…
wait_for() {
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    [ "$SECONDS" -lt "$end" ] || return 1
    sleep 0.2
  done
}

# ours PID NAME: it is alive, of this name and of this cluster. (What ended and was not reaped has no environment.)
ours() {
  [ "$(cat "/proc/$1/comm" 2>/dev/null)" = "$2" ] && grep -qzxF "SLURM_CONF=$SLURM_CONF" "/proc/$1/environ" 2>/dev/null
}
# daemon FILE NAME: the process that wrote its number to $cluster/FILE.pid, if it is alive.
daemon() {
  local pid
  pid=$(cat "$cluster/$1.pid" 2>/dev/null) && ours "$pid" "$2" && echo "$pid"
}
# steps_of NODE: the processes that hold tasks there, told by the log of their node. They outlive its slurmd.
steps_of() {
  local entry
  for entry in /proc/[0-9]*; do
    ours "${entry#/proc/}" slurmstepd || continue
    [ "$(readlink "$entry/fd/3" 2>/dev/null)" = "$cluster/$1.log" ] && echo "${entry#/proc/}"
  done
}

# Slurm listens where the name of the machine resolves to. Where that is no address of loopback, its daemons are told
# that the machine is called localhost.
is_loopback() {
  local addresses
  addresses=$(getent ahostsv4 "$(uname -n)" | cut -d ' ' -f 1)
  [ -n "$addresses" ] && ! grep -qv '^127\.' <<<"$addresses"
}
start() {
  if is_loopback; then
    "$@" </dev/null >>"$cluster/start.log" 2>&1
  else
    unshare --uts sh -c 'hostname localhost && exec "$@"' sh "$@" </dev/null >>"$cluster/start.log" 2>&1
  fi
}
start_node() { start slurmd -N "$1"; }

# A first port after which so many are free, too; below those that clients get.
free_ports() {
  local first port
  while :; do
    first=$((12000 + RANDOM % 15000))
    for ((port = first; port <= first + $1; ++port)); do
      (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null && continue 2
    done
    echo "$first"
    return
  done
}

write_configuration() {
  local nodes=$1 port
  port=$(free_ports "$nodes")
  # Even what uses no cgroups opens a plugin of them; the one for version 1 touches nothing until asked.
  printf 'CgroupPlugin=cgroup/v1\nCgroupAutomount=no\n' >"$cluster/cgroup.conf"
  # cred_expire is also how long what was queued again waits at least.
  cat >"$SLURM_CONF" <<END
ClusterName=throwaway
SlurmctldHost=localhost(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
SlurmctldPort=$port
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$cluster/munge.socket,cred_expire=5
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/spool.%n
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmdPidFile=$cluster/%n.pid
SlurmctldLogFile=$cluster/slurmctld.log
SlurmdLogFile=$cluster/%n.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=2,bf_interval=2
SlurmdParameters=config_overrides
ReturnToService=2
JobRequeue=1
SlurmdTimeout=6
KillWait=2
NodeName=n[1-$nodes] NodeHostname=localhost NodeAddr=127.0.0.1 Port=[$((port + 1))-$((port + nodes))] CPUs=1
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
}

node_is() { sinfo -h -n "$1" -o '%T' 2>/dev/null | grep -qE "^($2)"; }

# cluster_up NODES: of one core each. False: why stands in $cluster/*.log.
cluster_up() {
  local i
  is_loopback || unshare --uts true || return
  mkdir -m 700 "$cluster/state"
  write_configuration "$1"
  (umask 077 && head -c 1024 /dev/urandom >"$cluster/munge.key")
  start munged --socket="$cluster/munge.socket" --key-file="$cluster/munge.key" --pid-file="$cluster/munged.pid" \
    --log-file="$cluster/munged.log" --seed-file="$cluster/munge.seed" || return
  start slurmctld || return
  for ((i = 1; i <= $1; ++i)); do
    mkdir "$cluster/spool.n$i"
    start_node "n$i" || return
  done
  for ((i = 1; i <= $1; ++i)); do wait_for 60 node_is "n$i" idle || return; done
}

# kill_node NODE: all of it at once, as when its power goes: first what would tell of the end of its tasks.
kill_node() {
  local pid child
  kill -KILL "$(daemon "$1" slurmd)"
  for pid in $(steps_of "$1"); do
    child=$(cat "/proc/$pid"/task/*/children 2>/dev/null)
    kill -KILL "$pid"
    for child in $child; do kill -KILL -- "-$child" 2>/dev/null || kill -KILL "$child"; done
  done
  rm -f "$cluster/$1.pid"
}

# end_daemon FILE NAME
end_daemon() {
  local pid
  pid=$(daemon "$1" "$2") || return 0
  kill "$pid"
  wait_for 10 eval "! ours $pid $2" || kill -KILL "$pid"
}
cluster_down() {
  local file
  if daemon slurmctld slurmctld >/dev/null; then
    timeout 10 scancel -u "$(id -un)"
    wait_for 10 eval '! squeue -h | grep -q .'
  fi
  end_daemon slurmctld slurmctld
  for file in "$cluster"/n*.pid; do end_daemon "$(basename "$file" .pid)" slurmd; done
  end_daemon munged munged
}
