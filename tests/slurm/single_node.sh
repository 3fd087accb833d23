#!/usr/bin/env bash
# A Slurm of one node on the loopback address, in a folder of its own: sets it up, runs a command in it, takes it down.
#
#     tests/slurm/single_node.sh                     the tests that need a Slurm
#     tests/slurm/single_node.sh COMMAND [WORD...]   any command; sbatch, squeue and the others work in it
#
# Takes munge, slurmctld and slurmd from Debian's packages. Where these are not installed and cannot be (no root, no
# apt-get, no package server), or the daemons do not come up, it says SKIPPED and ends with 0. Nothing of it stays but
# the packages; /etc/slurm and /etc/munge are not read.
set -euo pipefail
cd "$(dirname "$0")/../.."

skip() {
    echo "SKIPPED: no Slurm was set up, so job arrays were not tried on one: $1" >&2
    exit 0
}

[ "$(id -u)" = 0 ] || skip "slurmd runs as root"
for program in munged slurmctld slurmd sbatch; do
    command -v "$program" >/dev/null && continue
    command -v apt-get >/dev/null || skip "$program is not installed, and there is no apt-get"
    # Services of the packages are not needed: the daemons here are this script's own.
    { apt-get update && RUNLEVEL=1 DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
        munge slurm-client slurmctld slurmd; } >/dev/null 2>&1 || skip "its packages cannot be installed"
done

place=$(mktemp -d -t slurm-single-node.XXXXXX)
chmod 755 "$place"
daemons=()
take_down() {
    code=$?
    # The node first: its tasks end with it.
    SLURM_CONF="$place/slurm.conf" scancel --full --signal=KILL --user=root >/dev/null 2>&1 || true
    for daemon in "${daemons[@]}"; do
        kill "$daemon" 2>/dev/null || true
    done
    # slurmd waits for its tasks' last words, for minutes where a task is gone without any.
    for _ in $(seq 50); do
        kill -0 "${daemons[@]}" 2>/dev/null || break
        sleep 0.1
    done
    for daemon in "${daemons[@]}"; do
        kill -KILL "$daemon" 2>/dev/null || true
        wait "$daemon" 2>/dev/null || true
    done
    rm -rf "$place"
    exit "$code"
}
trap take_down EXIT

free_port() {
    python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

mkdir -p "$place/state" "$place/spool" "$place/munge"
chmod 700 "$place/munge"
head -c 1024 /dev/urandom >"$place/munge/key"
chmod 600 "$place/munge/key"
munged --foreground --force --key-file="$place/munge/key" --socket="$place/munge.socket" \
    --pid-file="$place/munge/pid" --seed-file="$place/munge/seed" --log-file="$place/munge/log" >/dev/null 2>&1 &
daemons+=($!)

host=$(hostname -s)
cat >"$place/slurm.conf" <<CONF
ClusterName=single
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$place/munge.socket
CredType=cred/munge
StateSaveLocation=$place/state
SlurmdSpoolDir=$place/spool
SlurmctldPidFile=$place/slurmctld.pid
SlurmdPidFile=$place/slurmd.pid
SlurmctldLogFile=$place/slurmctld.log
SlurmdLogFile=$place/slurmd.log
# No control groups and no accounting: neither is there in a container.
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_min_interval=100000,batch_sched_delay=1
KillWait=2
MinJobAge=300
MaxArraySize=5
# Two CPUs, whatever the machine has: two tasks fill the partition, and the third waits.
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=work Nodes=$host Default=YES MaxTime=INFINITE State=UP
PartitionName=short Nodes=$host MaxTime=1 State=UP
CONF
export SLURM_CONF="$place/slurm.conf"

for _ in $(seq 100); do
    [ -S "$place/munge.socket" ] && break
    sleep 0.1
done
slurmctld -D -f "$SLURM_CONF" >/dev/null 2>&1 &
daemons+=($!)
slurmd -D -f "$SLURM_CONF" -N "$host" >/dev/null 2>&1 &
daemons+=($!)
for _ in $(seq 300); do
    state=$(sinfo --noheader --partition=work --format=%T 2>/dev/null || true)
    [ "$state" = idle ] && break
    sleep 0.1
done
if [ "$state" != idle ]; then
    tail -n 5 "$place"/slurm*.log >&2 || true
    skip "the node did not become idle within 30 s (it is: ${state:-absent})"
fi
echo "Slurm $(sinfo --version | cut -d' ' -f2): one node with 2 CPUs, MaxArraySize 5" >&2

if [ $# -eq 0 ]; then
    set -- cargo test --locked -p trainer --test acceptance slurm::
fi
RINGDOWN_SLURM=1 "$@"
