#!/usr/bin/env bash
# Run a command while a real SLURM of one node is up, which ends with the command:
#
#     tests/workflow/loopback.sh squeue
#
# Needed: root, and slurmctld, slurmd, sinfo, munged (Debian: slurmctld slurmd slurm-client munge), unshare, ip. Everything
# happens in namespaces of its own (mounts, processes, network, host name): /etc/slurm is covered, not changed, a SLURM or
# munge that runs already is neither seen nor disturbed, and all daemons end with the command. Exit status: that of the
# command; 69 with a reason on stderr if SLURM cannot be started here.
set -euo pipefail

unavailable() {
    echo "loopback SLURM: $1" >&2
    exit 69
}

if [ "${1:-}" != --inside ]; then
    [ $# -gt 0 ] || { echo "usage: $0 COMMAND [ARGUMENT …]" >&2; exit 64; }
    PATH="$PATH:/usr/sbin:/sbin"
    for program in slurmctld slurmd sinfo srun sbatch munged unshare ip; do
        command -v "$program" >/dev/null \
            || unavailable "$program is missing: apt-get install slurmctld slurmd slurm-client munge iproute2"
    done
    [ "$(id -u)" -eq 0 ] || unavailable "only root may start slurmd: sudo make test"
    [ -d /etc/slurm ] || unavailable "there is no /etc/slurm to cover"
    own=(unshare --mount --uts --ipc --net --pid --fork --kill-child --mount-proc)
    "${own[@]}" true 2>/dev/null || unavailable "no namespaces of one's own are allowed here"
    folder="$(mktemp -d -t slurm.XXXXXX)"
    trap 'rm -rf "$folder"' EXIT
    "${own[@]}" "$0" --inside "$folder" "$@"
    exit
fi

folder="$2"
shift 2
hostname loopback
ip link set lo up
# Names are resolved to IPv4 addresses only where an address other than 127.0.0.1 is there: one that leads nowhere (RFC 5737).
address=192.0.2.1
ip address add "$address/32" dev lo
mkdir -p "$folder"/{munge,state,spool,log}
chmod 755 "$folder"
printf '%s\n' "127.0.0.1 localhost" "$address loopback" > "$folder/hosts"
mount --bind "$folder/hosts" /etc/hosts
mount -t tmpfs slurm /etc/slurm

# What a node offers: all processors, and nine tenths of the memory of the machine.
memory_mb=$(awk '/^MemTotal:/ { printf "%d", 0.9 * $2 / 1024 }' /proc/meminfo)
# The place is fixed: the job step of the executor drops SLURM_CONF from the environment of its srun.
cat > /etc/slurm/slurm.conf <<CONF
ClusterName=loopback
SlurmctldHost=loopback($address)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
# No accounting data base: ask squeue, not sacct. A job that takes more memory than it asked for is ended.
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=task=1
JobAcctGatherParams=OverMemoryKill
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
ReturnToService=2
SchedulerParameters=batch_sched_delay=0
MinJobAge=300
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/log/slurmctld
SlurmdLogFile=$folder/log/slurmd
NodeName=loopback NodeAddr=$address CPUs=$(nproc) RealMemory=$memory_mb State=UNKNOWN
PartitionName=all Nodes=loopback Default=YES MaxTime=INFINITE State=UP
CONF

failed() {
    tail -n 20 "$folder"/log/* >&2 || true
    unavailable "$1"
}

(umask 077 && head -c 1024 /dev/urandom > "$folder/munge/key")
munged --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --num-threads=2 \
    --pid-file="$folder/munge/pid" --seed-file="$folder/munge/seed" --log-file="$folder/log/munged" \
    || failed "munged did not start"
slurmctld || failed "slurmctld did not start"
slurmd -N loopback || failed "slurmd did not start"
until [ "$(timeout 5 sinfo --noheader --format=%T 2>/dev/null || true)" = idle ]; do
    [ "$SECONDS" -lt 30 ] || failed "the node is not ready after 30 s"
    sleep 0.1
done

# This is the first process of the namespace: all others end with it. In the background, so that a signal is heard.
trap 'exit 143' HUP INT TERM
status=0
"$@" <&0 &
wait $! || status=$?
exit "$status"
