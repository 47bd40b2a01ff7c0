//! Scripts for Slurm: their content, and the values that are refused.

use super::{by_part, by_queue, worker};
use wayword_queue::launch::{
    LaunchError,
    slurm::{SlurmJob, write_script},
};

fn small() -> SlurmJob {
    SlurmJob::new(by_part(), "4:00:00")
}

#[test]
fn a_small_script_has_a_part_for_each_worker() {
    insta::assert_snapshot!("slurm_small", write_script(&small()).unwrap());
}

#[test]
fn a_full_script_has_a_queue_and_all_that_slurm_can_be_asked_for() {
    let job = SlurmJob {
        name: "big.run".to_owned(),
        gpus: 1,
        cpus: 8,
        memory: Some("32G".to_owned()),
        partition: Some("gpu,long".to_owned()),
        account: Some("robots".to_owned()),
        logs: "/scratch/it's 100%/".to_owned(),
        export: ["PGPASSFILE", "OPENAI_API_KEY", "HOME"].map(str::to_owned).to_vec(),
        ..SlurmJob::new(by_queue(2000), "1-12:00:00")
    };
    insta::assert_snapshot!("slurm_full", write_script(&job).unwrap());
}

#[test]
fn script_of_a_large_array_warns_about_cluster_limits() {
    let has_hint = |workers| {
        let job = SlurmJob::new(by_queue(workers), "90");
        write_script(&job).unwrap().contains("MaxArraySize")
    };
    assert_eq!([1, 1001, 1002].map(has_hint), [false, false, true]);
}

#[test]
fn script_refuses_values_that_slurm_would_misread() {
    let text = |value: &str| Some(value.to_owned());
    let wrong = [
        SlurmJob { name: "a b".to_owned(), ..small() },
        SlurmJob { name: "a\n#SBATCH --uid=0".to_owned(), ..small() },
        SlurmJob { name: String::new(), ..small() },
        SlurmJob { time: "4h".to_owned(), ..small() },
        SlurmJob { time: "2".to_owned(), ..small() },
        SlurmJob { cpus: 0, ..small() },
        SlurmJob { memory: text("16 G"), ..small() },
        SlurmJob { memory: text("16Gi"), ..small() },
        SlurmJob { partition: text("gpu --uid=0"), ..small() },
        SlurmJob { account: text("-a"), ..small() },
        SlurmJob { logs: String::new(), ..small() },
        SlurmJob { logs: "a\" --uid=0 \"".to_owned(), ..small() },
        SlurmJob { logs: "a\\b".to_owned(), ..small() },
        SlurmJob { logs: "a\nb".to_owned(), ..small() },
        SlurmJob { export: vec!["PGPASSWORD=geheim".to_owned()], ..small() },
        SlurmJob { export: vec!["A,ALL".to_owned()], ..small() },
        SlurmJob { worker: worker(&["a\nb"], 1), ..small() },
        SlurmJob { worker: worker(&["--queue=postgresql://me:geheim@host/db"], 1), ..small() },
        SlurmJob { worker: worker(&[], 0), ..small() },
        SlurmJob { worker: wayword_queue::launch::LaunchWorker { program: String::new(), ..by_part() }, ..small() },
    ];
    for given in wrong {
        let error = write_script(&given).unwrap_err();
        assert!(!matches!(error, LaunchError::Template(_)), "{given:?}: {error}");
        let error = error.to_string();
        assert!(error.contains("\nhint: ") && !error.contains("geheim"), "{error}");
    }
}
