#!/bin/sh
# The Slurm recipe of docs/machines.md with a cluster of one machine, which lives in the folder $1 and ends with the script.
# Ends with 77 where this machine has no Slurm, or lets nobody start one. $2 is the page, $3 the folder of the program.
set -eu
cd "$1"
page=$2
PATH=$3:/usr/sbin:$PATH
for tool in slurmctld slurmd sbatch squeue munged mungekey; do
    command -v "$tool" >/dev/null || { echo "no $tool"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "only root can start it"; exit 77; }

here=$PWD
mkdir state spool
end() {
    for pid in "$here"/*.pid; do
        [ -f "$pid" ] && kill "$(cat "$pid")" 2>/dev/null || true
    done
}
trap end EXIT
mungekey --create --keyfile="$here/munge.key"
# munged wants its files in folders that nobody else may write to.
chmod 755 "$here"
munged --force --key-file="$here/munge.key" --socket="$here/munge.socket" --pid-file="$here/munged.pid" \
    --log-file="$here/munged.log" --seed-file="$here/munge.seed" || { echo "munged does not start"; exit 77; }
export SLURM_CONF="$here/slurm.conf"
host=$(hostname -s)
port=$((20000 + $$ % 20000))
cat > slurm.conf <<CONF
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket=$here/munge.socket
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$here/state
SlurmdSpoolDir=$here/spool
SlurmctldPidFile=$here/slurmctld.pid
SlurmdPidFile=$here/slurmd.pid
SlurmctldLogFile=$here/slurmctld.log
SlurmdLogFile=$here/slurmd.log
SlurmctldPort=$port
SlurmdPort=$((port + 1))
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
slurmctld && slurmd || { echo "Slurm does not start"; exit 77; }
waited=0
until sinfo -h -t idle | grep -q "$host"; do
    waited=$((waited + 1))
    [ "$waited" -lt 30 ] || { echo "the node does not come up"; cat ./*.log; exit 77; }
    sleep 1
done

size='--size 640x480 --aa grid=5'
dotray render room.ray whole.png $size
dotray plan room.ray -o room.plan --pieces 16 $size --quiet
# The page's script, on one core a task: there may be no more.
awk '/^## Slurm/ { found = 1 } found && /^```sh/ { inside = 1; next } inside && /^```/ { exit } inside' "$page" |
    sed 's/--threads 4/--threads 1/; s/cpus-per-task=4/cpus-per-task=1/' > job.sh
grep -q SLURM_ARRAY_TASK_ID job.sh
job=$(sbatch --parsable job.sh)
# A task that is stopped in its midst and started again makes the same piece.
waited=0
until squeue -h -r -j "${job}_0" -t running -o %i | grep -q .; do
    waited=$((waited + 1))
    [ "$waited" -lt 600 ] || { squeue; cat ./*.log; exit 1; }
    sleep 0.1
done
scontrol requeue "${job}_0"
finish() {
    waited=0
    while [ -n "$(squeue -h)" ]; do
        waited=$((waited + 1))
        [ "$waited" -lt 120 ] || { squeue; cat slurm-*.out; exit 1; }
        # Slurm holds a task that was requeued back for two minutes.
        for held in $(squeue -h -r -t pending -o '%i %r' | sed -n 's/ BeginTime$//p'); do
            scontrol update "JobId=$held" StartTime=now || true
        done
        sleep 1
    done
}
finish
scontrol show job "${job}_0" | grep -q 'Restarts=1' || { echo "the task was not started again"; exit 1; }
dotray merge room.plan pieces -o room.png || { cat slurm-*.out; exit 1; }
cmp room.png whole.png
# As the page says: the merge tells which numbers to give to --array.
rm room.png pieces/piece-00004.tiles pieces/piece-00005.tiles pieces/piece-00009.tiles
if dotray merge room.plan pieces -o room.png 2>said; then exit 1; fi
missing=$(sed -n 's/.*not whole: \([0-9, -]*\).*/\1/p' said | tr -d ' ')
[ "$missing" = 4-5,9 ]
job=$(sbatch --parsable --array="$missing" job.sh)
# The second job of the page.
sbatch --dependency="afterok:$job" --wrap "dotray merge room.plan pieces -o room.png" >/dev/null
finish
cmp room.png whole.png
