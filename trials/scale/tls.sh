#!/usr/bin/env bash
# Reaches a PostgreSQL server by TLS and with a password, as workers reach one on another machine. See README.md.
# Needs PostgreSQL's programs and openssl, and root, because it starts the server as another user.
set -euo pipefail
cd "$(dirname "$0")/../.."
cargo build --quiet --features queue
wayword=$PWD/target/debug/wayword
PATH=$PATH:$(echo /usr/lib/postgresql/*/bin)
folder=$(mktemp -d)
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
as=(setpriv --reuid postgres --regid postgres --clear-groups --)
stop() {
    "${as[@]}" pg_ctl --silent --mode=immediate --pgdata="$folder/data" stop || true
    rm -rf "$folder"
}
trap stop EXIT

# Two authorities, and a server's certificate by the first, for the name localhost.
cd "$folder"
for authority in right wrong; do
    openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj "/CN=$authority" -keyout "$authority.key" -out "$authority.pem" 2>openssl.log
done
openssl req -newkey rsa:2048 -nodes -subj /CN=localhost -keyout server.key -out server.csr 2>>openssl.log
openssl x509 -req -in server.csr -CA right.pem -CAkey right.key -CAcreateserial -days 2 -out server.crt \
    -extfile <(echo subjectAltName=DNS:localhost) 2>>openssl.log
echo geheim >superuser
chown -R postgres "$folder"
chmod 700 "$folder" server.key
"${as[@]}" initdb --pgdata=data --username=owner --pwfile=superuser --auth-host=scram-sha-256 --auth-local=trust >initdb.log
"${as[@]}" tee -a data/postgresql.conf >/dev/null <<CONF
listen_addresses = 'localhost'
port = $port
unix_socket_directories = '$folder'
ssl = on
ssl_cert_file = '$folder/server.crt'
ssl_key_file = '$folder/server.key'
CONF
sed -i 's/^host /hostssl /' data/pg_hba.conf
"${as[@]}" pg_ctl --silent --wait --pgdata=data --log=server.log start

faults=0
# Whether a worker's command ends with a code, and says something.
expect() {
    local what=$1 code=$2 words=$3 said ended=0
    shift 3
    said=$(env PGPASSFILE="$folder/pass" "$@" "$wayword" runs database "postgresql://owner@localhost:$port/postgres?sslmode=require" 2>&1) || ended=$?
    if [[ $ended == "$code" && $said == *"$words"* ]]; then
        echo "ok     $what: $ended"
    else
        echo "FAULT  $what: $ended, and not $code with \"$words\": $said"
        faults=$((faults + 1))
    fi
    [[ $said != *geheim* ]] || { echo "FAULT  $what: the password is told"; faults=$((faults + 1)); }
}
printf 'localhost:%s:*:owner:geheim\n' "$port" >pass
chmod 600 pass
expect 'the right authority' 0 'the tables are there' PGSSLROOTCERT="$folder/right.pem"
expect 'another authority' 7 'certificate' PGSSLROOTCERT="$folder/wrong.pem"
expect 'the public authorities' 7 'certificate' PGSSLROOTCERT=
printf 'localhost:%s:*:owner:falsch\n' "$port" >pass
expect 'a wrong password' 1 'password' PGSSLROOTCERT="$folder/right.pem"
chmod 644 pass
expect 'a password file that all may read' 1 'chmod 600' PGSSLROOTCERT="$folder/right.pem"
((faults == 0)) && echo "all as expected"
