//! The routes of the site: which function answers at which address.
//!
//! Requests without a session lead to the consent page or to a message. All others end in the page of the participant's stage: a
//! form is stored, and the browser is redirected to `/`, which shows that page. So a reload never sends a form twice.

use super::{
    cookies::Cookies,
    desk::{Busy, Desk},
    forms::{self, Fields},
    gate::{self, Asker, Pace},
    pages::{Around, Page, Pages, consent_version, mark, refused},
};
use crate::{
    store::{Arrival, Book, Entry, Given, Refusal, Withdrawal},
    study::{Mode, Recruiter, Study, StudyError},
    token::is_token,
};
use axum::{
    Router,
    body::Body,
    extract::{DefaultBodyLimit, Form, FromRequest as _, Path, Query, Request, State, rejection::PathRejection},
    http::{HeaderMap, HeaderValue, StatusCode, header},
    middleware::{self, Next},
    response::{IntoResponse, Response},
    routing::{get, post},
};
use std::{collections::BTreeMap, sync::Arc, time::Duration};
use tokio::sync::Semaphore;

/// Longest body of a form, bytes.
const MOST_BYTES: usize = 16 * 1024;
/// How long a request may take, including its body.
const PATIENCE: Duration = Duration::from_secs(15);
/// The assignment id that MTurk sends while a worker only previews a task.
const PREVIEW: &str = "ASSIGNMENT_ID_NOT_AVAILABLE";
/// Seconds after which to try again.
const AGAIN: HeaderValue = HeaderValue::from_static("1");

/// Shared state of all requests.
pub(super) struct Site {
    pub(super) study: Arc<Study>,
    pub(super) desk: Desk,
    pub(super) pages: Pages,
    pub(super) cookies: Cookies,
    pub(super) pace: Pace,
    /// Limits how many pictures are read at once, and so how much memory they take.
    pub(super) readers: Semaphore,
    /// The address that participants use, if it is not the one that the site listens on.
    pub(super) public: Option<String>,
    /// `http` or `https`, as the site itself is reached.
    pub(super) scheme: &'static str,
}

type Shared = State<Arc<Site>>;
/// Slot and file name in the address of a picture, or why they could not be read.
type SlotFile = Result<Path<(String, String)>, PathRejection>;

/// Builds the router with all addresses.
pub(super) fn router(site: Arc<Site>) -> Router {
    Router::new()
        .route("/", get(place))
        .route("/t/{token}", get(personal))
        .route("/join", get(join))
        .route("/consent", post(consent))
        .route("/understood", post(understood))
        .route("/write", post(write))
        .route("/move", post(step))
        .route("/stop", post(stop))
        .route("/answer", post(answer))
        .route("/attention", post(attention))
        .route("/withdraw", get(leave).post(withdraw))
        .route("/look/{slot}/{file}", get(look))
        .route("/film/{slot}/{file}", get(film))
        .route("/style.css", get(|| asset("text/css; charset=utf-8", include_str!("assets/style.css"))))
        .route("/script.js", get(|| asset("text/javascript; charset=utf-8", include_str!("assets/script.js"))))
        .route("/favicon.ico", get(|| async { StatusCode::NO_CONTENT }))
        .fallback(|State(site): Shared| async move { Problem::Missing.page(&site) })
        .method_not_allowed_fallback(|State(site): Shared| async move { Problem::Method.page(&site) })
        .layer(DefaultBodyLimit::max(MOST_BYTES))
        .layer(middleware::from_fn_with_state(Arc::clone(&site), guard))
        .with_state(site)
}

/// Wraps every request: checks the origin of forms, limits the time, and adds the security headers.
async fn guard(State(site): Shared, request: Request, next: Next) -> Response {
    let is_foreign =
        gate::changes(request.method()) && !gate::is_own(request.headers(), site.public.as_deref(), site.scheme);
    let mut response = if is_foreign {
        Problem::Foreign.page(&site)
    } else {
        match tokio::time::timeout(PATIENCE, next.run(request)).await {
            Ok(response) => response,
            Err(_) => Problem::Busy.page(&site),
        }
    };
    for (name, value) in gate::headers(site.cookies.is_secure) {
        response.headers_mut().entry(name).or_insert(value);
    }
    response
}

/// Why a request gets an error page.
#[derive(Debug, Clone, Copy)]
enum Problem {
    Missing,
    Method,
    Foreign,
    NoSession,
    Fast,
    Busy,
    Large,
    Form,
    OutOfTurn,
    Returned,
    Closed,
    Fault,
}

impl Problem {
    fn page(self, site: &Site) -> Response {
        let (status, heading, text, retry) = match self {
            Self::Missing => (StatusCode::NOT_FOUND, "There is nothing here", "Please open your link again.", false),
            Self::Method => {
                (StatusCode::METHOD_NOT_ALLOWED, "There is nothing here", "Please open your link again.", false)
            }
            Self::Foreign => (
                StatusCode::FORBIDDEN,
                "This came from another site",
                "Please open your link again, and go on there.",
                false,
            ),
            Self::NoSession => (
                StatusCode::FORBIDDEN,
                "We do not know who you are",
                "Please open the link again with which you started. Your answers are kept.",
                false,
            ),
            Self::Fast => (StatusCode::TOO_MANY_REQUESTS, "That was very fast", "Please wait a moment.", true),
            Self::Busy => (StatusCode::SERVICE_UNAVAILABLE, "Not yet stored", "Please try again in a moment.", true),
            Self::Large => (StatusCode::PAYLOAD_TOO_LARGE, "That was too much", "Please write less.", false),
            Self::Form => (StatusCode::BAD_REQUEST, "We could not read that", "Please load the page again.", true),
            Self::OutOfTurn => (StatusCode::CONFLICT, "You are at another place", "Please load the page again.", true),
            Self::Returned => (
                StatusCode::CONFLICT,
                "This one went to somebody else",
                "You were away for a long time. Please go on with the next one.",
                true,
            ),
            Self::Closed => (StatusCode::GONE, "This study is over", "It takes no more answers. Thank you.", false),
            Self::Fault => {
                (StatusCode::INTERNAL_SERVER_ERROR, "Something went wrong", "Please try again in a moment.", true)
            }
        };
        let mut response = shown(site, status, &Page::message(&site.study, heading, text, retry));
        if matches!(self, Self::Fast | Self::Busy) {
            response.headers_mut().insert(header::RETRY_AFTER, AGAIN);
        }
        response
    }
}

impl From<Busy> for Problem {
    fn from(_: Busy) -> Self {
        Self::Busy
    }
}

impl From<Refusal> for Problem {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Unknown => Self::Missing,
            Refusal::OutOfTurn => Self::OutOfTurn,
            Refusal::Returned => Self::Returned,
            Refusal::Closed => Self::Closed,
        }
    }
}

fn shown(site: &Site, status: StatusCode, page: &Page) -> Response {
    let html = header::HeaderValue::from_static("text/html; charset=utf-8");
    match site.pages.html(page) {
        Ok(text) => (status, [(header::CONTENT_TYPE, html)], text).into_response(),
        Err(_) => (StatusCode::INTERNAL_SERVER_ERROR, "This page cannot be shown.").into_response(),
    }
}

/// Redirects to `/` and sets cookies.
fn onwards(cookies: impl IntoIterator<Item = Option<HeaderValue>>) -> Response {
    let mut response = (StatusCode::SEE_OTHER, [(header::LOCATION, HeaderValue::from_static("/"))]).into_response();
    for cookie in cookies.into_iter().flatten() {
        response.headers_mut().append(header::SET_COOKIE, cookie);
    }
    response
}

async fn asset(kind: &'static str, text: &'static str) -> Response {
    ([(header::CONTENT_TYPE, HeaderValue::from_static(kind))], text).into_response()
}

fn ended(result: Result<Response, Problem>, site: &Site) -> Response {
    result.unwrap_or_else(|problem| problem.page(site))
}

/// Finds the participant who asks, and applies the rate limit of participants or of strangers.
async fn who(site: &Site, headers: &HeaderMap) -> Result<Option<(i64, String)>, Problem> {
    let found = known(site, headers).await?;
    let asker = found.as_ref().map_or(Asker::Stranger, |(person, _)| Asker::Person(*person));
    if site.pace.allows(asker) { Ok(found) } else { Err(Problem::Fast) }
}

/// The participant of a session and the person's mark. For a cookie that was never valid, the strangers' rate limit is applied before
/// the database is asked.
async fn known(site: &Site, headers: &HeaderMap) -> Result<Option<(i64, String)>, Problem> {
    let session = site.cookies.session(headers).filter(|session| is_token(session));
    Ok(match session {
        Some(session) => {
            if !site.pace.knows(&session) && !site.pace.allows(Asker::Stranger) {
                return Err(Problem::Fast);
            }
            let asked = session.clone();
            let found = site.desk.ask(move |book| book.whose(&asked)).await?;
            if found.is_some() {
                site.pace.remember(session);
            }
            found.map(|(person, name)| (person, mark(&name)))
        }
        None => None,
    })
}

async fn person(site: &Site, headers: &HeaderMap) -> Result<(i64, Around), Problem> {
    let (person, mark) = who(site, headers).await?.ok_or(Problem::NoSession)?;
    Ok((person, Around { who: Some(mark), ..Around::default() }))
}

/// Answers `/`: the page of the participant's stage, the consent page for a new arrival, or a message.
async fn place(State(site): Shared, headers: HeaderMap) -> Response {
    let page = async {
        if let Some((person, mark)) = who(&site, &headers).await? {
            let around = Around { who: Some(mark), ..Around::default() };
            return standing(&site, person, around, StatusCode::OK).await;
        }
        let Some(arrival) = site.cookies.arrival(&headers) else {
            return Ok(shown(&site, StatusCode::OK, &refused(&site.study, &Entry::Unknown)));
        };
        match site.desk.ask(move |book| book.enter(&arrival)).await? {
            Entry::New => Ok(shown(&site, StatusCode::OK, &Page::consent(&site.study, &Around::default()))),
            entry => Ok(entered(&site, entry)),
        }
    };
    ended(page.await, &site)
}

async fn standing(site: &Site, person: i64, around: Around, status: StatusCode) -> Result<Response, Problem> {
    let page = move |book: &Book<'_>| {
        if book.is_closed()? && !book.is_over(person)? {
            return Ok(None);
        }
        Page::of_stage(book, person, &around).map(Some)
    };
    match site.desk.ask(page).await? {
        Some(page) => Ok(shown(site, status, &page)),
        None => Err(Problem::Closed),
    }
}

/// Answers an arrival: opens a session for a participant, and shows a message otherwise.
fn entered(site: &Site, entry: Entry) -> Response {
    match entry {
        Entry::Back(session) => onwards([site.cookies.set_session(&session), site.cookies.drop_arrival()]),
        entry => {
            let status = match entry {
                Entry::Full => StatusCode::CONFLICT,
                Entry::Closed => StatusCode::GONE,
                _ => StatusCode::FORBIDDEN,
            };
            shown(site, status, &refused(&site.study, &entry))
        }
    }
}

async fn arrive(site: &Site, arrival: Arrival) -> Result<Response, Problem> {
    if !site.pace.allows(Asker::Stranger) {
        return Err(Problem::Fast);
    }
    let asked = arrival.clone();
    Ok(match site.desk.ask(move |book| book.enter(&asked)).await? {
        // This ends the session of another person on the same machine. If the study is full, the page at `/` tries again.
        Entry::New | Entry::Full => onwards([site.cookies.set_arrival(&arrival), site.cookies.drop_session()]),
        entry => entered(site, entry),
    })
}

/// A personal link.
async fn personal(State(site): Shared, token: Result<Path<String>, PathRejection>) -> Response {
    let Ok(Path(token)) = token else { return Problem::Missing.page(&site) };
    ended(arrive(&site, Arrival::Link(token)).await, &site)
}

/// A recruiter's link. Its ids go into a cookie and out of the address at once, so that the browser's history does not show them.
async fn join(State(site): Shared, Query(query): Query<BTreeMap<String, String>>) -> Response {
    let Recruiter::Parameters { person, session, study, .. } = &site.study.settings.recruiter else {
        return Problem::Missing.page(&site);
    };
    if query.get(session).is_some_and(|session| session == PREVIEW) {
        let text = "Accept the task, and open its link again to take part.";
        return shown(&site, StatusCode::OK, &Page::message(&site.study, "This is a preview", text, false));
    }
    let value = |name: &String| query.get(name).cloned().unwrap_or_default();
    let arrival = Arrival::Recruit { person: value(person), session: value(session), study: value(study) };
    ended(arrive(&site, arrival).await, &site)
}

/// The fields of a form.
async fn fields(request: Request) -> Result<(HeaderMap, Fields), Problem> {
    let headers = request.headers().clone();
    match Form::<Vec<(String, String)>>::from_request(request, &()).await {
        Ok(Form(pairs)) => Ok((headers, pairs.into_iter().collect())),
        Err(rejection) if rejection.status() == StatusCode::PAYLOAD_TOO_LARGE => Err(Problem::Large),
        Err(_) => Err(Problem::Form),
    }
}

/// Whether the form belongs to the session that sends it. On a shared machine, an old tab may belong to another participant.
fn is_of(fields: &Fields, around: &Around) -> bool {
    fields.get("who").is_none_or(|who| around.who.as_ref() == Some(who))
}

async fn consent(State(site): Shared, request: Request) -> Response {
    let done = async {
        let (headers, fields) = fields(request).await?;
        if who(&site, &headers).await?.is_some() {
            return Ok(onwards([]));
        }
        let arrival = site.cookies.arrival(&headers).ok_or(Problem::NoSession)?;
        if fields.get("agree").map(String::as_str) != Some("yes") {
            let mut response = shown(&site, StatusCode::OK, &Page::gone(&site.study, false));
            // The next visitor at this machine is another person.
            if let Some(cookie) = site.cookies.drop_arrival() {
                response.headers_mut().append(header::SET_COOKIE, cookie);
            }
            return Ok(response);
        }
        let version = consent_version(&site.study);
        if fields.get("version").is_some_and(|read| *read != version) {
            let error = Some("This page has changed. Please read it once more.");
            let page = Page::consent(&site.study, &Around { error, ..Around::default() });
            return Ok(shown(&site, StatusCode::UNPROCESSABLE_ENTITY, &page));
        }
        Ok(entered(&site, site.desk.ask(move |book| book.consent(&arrival, &version)).await?))
    };
    ended(done.await, &site)
}

/// Stores the input of a form. If a field is missing, the page is shown again with a message.
async fn give(
    site: &Site,
    request: Request,
    read: impl FnOnce(&Fields) -> Result<Given, &'static str>,
) -> Result<Response, Problem> {
    let (headers, fields) = fields(request).await?;
    let (person, around) = person(site, &headers).await?;
    if !is_of(&fields, &around) {
        return Err(Problem::OutOfTurn);
    }
    match read(&fields) {
        Ok(given) => {
            site.desk.ask(move |book| book.give(person, given)).await??;
            Ok(onwards([]))
        }
        Err(error) => {
            let around = Around { error: Some(error), given: Some(fields), ..around };
            standing(site, person, around, StatusCode::UNPROCESSABLE_ENTITY).await
        }
    }
}

async fn understood(State(site): Shared, request: Request) -> Response {
    let questions = site.study.settings.questions.len();
    ended(give(&site, request, |fields| forms::understood(fields, questions)).await, &site)
}

async fn write(State(site): Shared, request: Request) -> Response {
    ended(give(&site, request, forms::own_text).await, &site)
}

async fn step(State(site): Shared, request: Request) -> Response {
    ended(give(&site, request, forms::step).await, &site)
}

async fn stop(State(site): Shared, request: Request) -> Response {
    ended(give(&site, request, forms::stop).await, &site)
}

async fn answer(State(site): Shared, request: Request) -> Response {
    let mode: Mode = site.study.plan.mode;
    ended(give(&site, request, |fields| forms::answer(fields, mode)).await, &site)
}

async fn attention(State(site): Shared, request: Request) -> Response {
    ended(give(&site, request, forms::attention).await, &site)
}

async fn leave(State(site): Shared, headers: HeaderMap) -> Response {
    let page = async {
        let (_, around) = person(&site, &headers).await?;
        Ok(shown(&site, StatusCode::OK, &Page::withdraw(&site.study, &around)))
    };
    ended(page.await, &site)
}

async fn withdraw(State(site): Shared, request: Request) -> Response {
    let done = async {
        let (headers, fields) = fields(request).await?;
        let is_delete = fields.get("delete").map(String::as_str) == Some("yes");
        let (person, around) = match person(&site, &headers).await {
            // The same request again: the first one was carried out, but its reply was lost.
            Err(Problem::NoSession) if is_delete => {
                return Ok(shown(&site, StatusCode::OK, &Page::gone(&site.study, true)));
            }
            found => found?,
        };
        if !is_of(&fields, &around) {
            return Err(Problem::OutOfTurn);
        }
        match fields.get("delete").map(String::as_str) {
            Some("yes") => {
                site.desk.ask(move |book| book.withdraw(person, Withdrawal::Delete)).await?;
                site.desk.sweep();
                let mut response = shown(&site, StatusCode::OK, &Page::gone(&site.study, true));
                if let Some(cookie) = site.cookies.drop_session() {
                    response.headers_mut().append(header::SET_COOKIE, cookie);
                }
                Ok(response)
            }
            Some("no") => {
                site.desk.ask(move |book| book.withdraw(person, Withdrawal::Keep)).await?;
                Ok(onwards([]))
            }
            _ => {
                let around = Around { error: Some("Please choose what happens to your answers."), ..around };
                Ok(shown(&site, StatusCode::UNPROCESSABLE_ENTITY, &Page::withdraw(&site.study, &around)))
            }
        }
    };
    ended(done.await, &site)
}

async fn look(State(site): Shared, path: SlotFile, headers: HeaderMap) -> Response {
    let Ok(Path((slot, file))) = path else { return Problem::Missing.page(&site) };
    let find = move |book: &Book<'_>, person, number| book.panorama(person, &slot, number);
    ended(picture(&site, &headers, &file, find).await, &site)
}

async fn film(State(site): Shared, path: SlotFile, headers: HeaderMap) -> Response {
    let Ok(Path((slot, file))) = path else { return Problem::Missing.page(&site) };
    let find = move |book: &Book<'_>, person, number| book.film_picture(person, &slot, number);
    ended(picture(&site, &headers, &file, find).await, &site)
}

/// Sends a picture of an item that this participant has. The file's name comes from the study, and never from the address.
async fn picture(
    site: &Site,
    headers: &HeaderMap,
    file: &str,
    find: impl FnOnce(&Book<'_>, i64, usize) -> Result<Option<String>, StudyError> + Send + 'static,
) -> Result<Response, Problem> {
    let number = file.strip_suffix(".jpg").and_then(|number| number.parse().ok()).ok_or(Problem::Missing)?;
    let (person, _) = known(site, headers).await?.ok_or(Problem::NoSession)?;
    if !site.pace.allows(Asker::Pictures(person)) {
        return Err(Problem::Fast);
    }
    let name = site.desk.ask(move |book| find(book, person, number)).await?.ok_or(Problem::Missing)?;
    let _place = site.readers.acquire().await.map_err(|_| Problem::Busy)?;
    let path = site.study.pictures().join(name);
    let bytes = tokio::task::spawn_blocking(move || std::fs::read(path)).await;
    let bytes = bytes.ok().and_then(Result::ok).ok_or(Problem::Fault)?;
    let headers = [
        (header::CONTENT_TYPE, HeaderValue::from_static("image/jpeg")),
        // A phone should not have to load a film twice. Caching is safe, because the address contains only a slot of this person.
        (header::CACHE_CONTROL, HeaderValue::from_static("private, max-age=3600")),
    ];
    Ok((headers, Body::from(bytes)).into_response())
}
