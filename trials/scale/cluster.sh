# A Slurm of one node, in a folder of its own and without systemd. Source it: `cluster_start FOLDER`, `cluster_stop`.
# It needs root, because slurmd gives jobs to their users, and slurmctld, slurmd, slurm-client and munge of Debian.
# shellcheck shell=bash

# The processes munged, slurmctld and slurmd.
cluster_pids=()

cluster_start() {
    local folder=$1
    mkdir -p "$folder"/{munge,state,spool,log}
    # munged refuses a socket or a key in a folder that others may write.
    chmod 755 "$folder" "$folder/munge"
    dd if=/dev/urandom of="$folder/munge/key" bs=128 count=1 status=none
    chmod 400 "$folder/munge/key"
    munged --foreground --force --num-threads=2 --key-file="$folder/munge/key" --socket="$folder/munge/socket" \
        --pid-file="$folder/munge/pid" --log-file="$folder/log/munged" --seed-file="$folder/munge/seed" &
    cluster_pids+=($!)
    local host
    host=$(hostname -s)
    cat >"$folder/slurm.conf" <<CONF
ClusterName=trial
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmctldPort=26817
SlurmdPort=26818
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/log/slurmctld
SlurmdLogFile=$folder/log/slurmd
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
ReturnToService=2
# Usual are 30 s and 300 s. The trial need not wait so long for the first, and looks at jobs long after they ended.
KillWait=5
MinJobAge=3600
NodeName=$host NodeAddr=127.0.0.1 CPUs=8 State=UNKNOWN
PartitionName=trial Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
    export SLURM_CONF="$folder/slurm.conf"
    until [[ -S $folder/munge/socket ]]; do sleep 0.2; done
    slurmctld -D &
    cluster_pids+=($!)
    slurmd -D &
    cluster_pids+=($!)
    local try
    for try in {1..60}; do
        [[ $(sinfo --noheader --format=%t 2>/dev/null) == idle ]] && return 0
        sleep 0.5
    done
    echo "Slurm did not start (tried $try times): see $folder/log" >&2
    return 1
}

cluster_stop() {
    local at
    # The last one first, so that slurmd can still tell slurmctld.
    for ((at = ${#cluster_pids[@]} - 1; at >= 0; at--)); do
        kill "${cluster_pids[at]}" 2>/dev/null
        wait "${cluster_pids[at]}" 2>/dev/null
    done
    cluster_pids=()
}
