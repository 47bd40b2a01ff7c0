#!/usr/bin/env bash
# Runs the tests of object stores against two simulators: moto for S3 and Azurite for Azure. No part of .ci/run,
# because it installs both. FOLDER keeps them for the next time.
#
#     trials/scale/objects.sh FOLDER
#
# Needs Python 3, Node with npm, PostgreSQL's programs, and Rust's toolchain.
set -euo pipefail
folder=$(realpath -m "${1:?"say where the simulators are to be kept: trials/scale/objects.sh FOLDER"}")
cd "$(dirname "$0")/../.."
export PATH=$folder/python/bin:$PATH

mkdir -p "$folder"
[ -x "$folder/python/bin/moto_server" ] || {
    python3 -m venv "$folder/python"
    pip install --quiet 'moto[server]==5.*' boto3
}
[ -x "$folder/node_modules/.bin/azurite-blob" ] || npm install --silent --prefix "$folder" azurite@3
data=$(mktemp -d)
started=()
stop() {
    kill "${started[@]}" 2>/dev/null || true
    wait 2>/dev/null || true
    rm -rf "$data"
}
trap stop EXIT

free_port() {
    python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}
# Waits until a port is open.
await() {
    for _ in $(seq 150); do
        if (exec 3<>"/dev/tcp/127.0.0.1/$1") 2>/dev/null; then return; fi
        sleep 0.2
    done
    echo "no server at port $1; see $data" >&2
    exit 1
}

s3=$(free_port)
moto_server -H 127.0.0.1 -p "$s3" >"$data/moto.log" 2>&1 &
started+=($!)
blob=$(free_port)
# Azurite may know older versions of the protocol than the client speaks.
"$folder/node_modules/.bin/azurite-blob" --silent --disableTelemetry --skipApiVersionCheck \
    --blobHost 127.0.0.1 --blobPort "$blob" --location "$data/azurite" >"$data/azurite.log" 2>&1 &
started+=($!)
await "$s3"
await "$blob"

# Both simulators take any request with these; neither is a secret. Azurite's account and key are in its documentation.
export AWS_ACCESS_KEY_ID=test AWS_SECRET_ACCESS_KEY=test AWS_REGION=us-east-1 AWS_DEFAULT_REGION=us-east-1
export AWS_ENDPOINT_URL=http://127.0.0.1:$s3 AWS_ALLOW_HTTP=true
export AZURE_STORAGE_USE_EMULATOR=true AZURITE_BLOB_STORAGE_URL=http://127.0.0.1:$blob
python3 - <<'PYTHON'
import boto3
boto3.client("s3").create_bucket(Bucket="wayword")
PYTHON
python3 trials/scale/container.py "$blob" wayword

WAYWORD_TEST_S3=s3://wayword/tests WAYWORD_TEST_AZURE=az://wayword/tests \
    cargo test -p wayword-queue --features cloud --locked --test it cloud:: -- "${@:2}"
# Runs whose workers send what they make.
for store in s3://wayword/runs az://wayword/runs; do
    WAYWORD_TEST_STORE=$store WAYWORD_TEST_POSTGRES=1 \
        cargo test -p wayword --no-default-features --features queue,cloud --locked --test it workers::in_stores -- "${@:2}"
done
