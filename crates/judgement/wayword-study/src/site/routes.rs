//! The routes of the site: which function answers at which address.
//!
//! Requests without a session lead to the consent page or to a message. All others end in the page of the participant's stage: a
//! form is stored, and the browser is redirected to `/`, which shows that page. So a reload never sends a form twice.

use super::{
    cookies::StudyCookies,
    desk::{DeskError, StudyDesk},
    forms::{self, FormFields},
    pages::{PageContext, PageTemplates, StudyPage, consent_version, person_mark, refusal_page},
    request_guard::{self, RequestLimiter, RequestSource},
};
use crate::{
    store::{
        ArrivalOutcome, InputRefusal, ParticipantArrival, ParticipantInput, StudyTransaction, WithdrawalChoice,
        may_be_issued,
    },
    study::{PageTexts, RecruiterSettings, Study, StudyError, StudyTask, fill_placeholders},
    token::is_token,
};
use axum::{
    Router,
    body::Body,
    extract::{DefaultBodyLimit, Form, FromRequest as _, Path, Query, Request, State, rejection::PathRejection},
    http::{HeaderMap, HeaderValue, StatusCode, Uri, header},
    middleware::{self, Next},
    response::{IntoResponse, Response},
    routing::{get, post},
};
use std::{collections::BTreeMap, sync::Arc, time::Duration};
use tokio::sync::Semaphore;

/// Longest body of a form, bytes. A longer one gets an error page.
const MAX_FORM_BYTES: usize = 16 * 1024;
/// Longest body of a form with texts of the participant's own, bytes. It is far above what is stored, so that who writes too much gets the text
/// back and can shorten it.
// `LARGEST_FORM` in assets/script.js is a little less.
const MAX_TEXT_FORM_BYTES: usize = 512 * 1024;
/// The address to which an arrival is led. Its query tells whether the browser sends the cookie back that came with it.
const ARRIVED_PAGE: HeaderValue = HeaderValue::from_static("/?arrived");
/// How long a request may take, including its body.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(15);
/// The assignment id that MTurk sends while a worker only previews a task.
const MTURK_PREVIEW_ID: &str = "ASSIGNMENT_ID_NOT_AVAILABLE";
/// Value of the header `Retry-After`: the seconds after which to try again.
const RETRY_AFTER_SECONDS: HeaderValue = HeaderValue::from_static("1");

/// Shared state of all requests.
pub(super) struct StudySite {
    pub(super) study: Arc<Study>,
    pub(super) desk: StudyDesk,
    pub(super) pages: PageTemplates,
    /// Whether this is a preview, in which nothing is stored.
    pub(super) is_preview: bool,
    /// The script of the pages, with its words.
    pub(super) script: String,
    pub(super) cookies: StudyCookies,
    pub(super) pace: RequestLimiter,
    /// Limits how many pictures are read at once, and so how much memory they take.
    pub(super) readers: Semaphore,
    /// The address that participants use, if it is not the one that the site listens on.
    pub(super) public: Option<String>,
    /// `http` or `https`, as the site itself is reached.
    pub(super) scheme: &'static str,
}

type SiteState = State<Arc<StudySite>>;
/// Slot and file name in the address of a picture, or why they could not be read.
type SlotFile = Result<Path<(String, String)>, PathRejection>;

/// Builds the router with all addresses.
pub(super) fn build_router(site: Arc<StudySite>) -> Router {
    Router::new()
        .route("/", get(show_current_page))
        .route("/t/{token}", get(open_personal_link))
        .route("/join", get(open_recruiter_link))
        .route("/consent", post(post_consent))
        .route("/understood", post(post_comprehension))
        .route("/write", post(post_own_text).layer(DefaultBodyLimit::max(MAX_TEXT_FORM_BYTES)))
        .route("/end", post(post_end).layer(DefaultBodyLimit::max(MAX_TEXT_FORM_BYTES)))
        .route("/preview", get(begin_preview))
        .route("/move", post(post_move))
        .route("/stop", post(post_stop))
        .route("/again", post(post_again))
        .route("/answer", post(post_answer))
        .route("/attention", post(post_attention))
        .route("/withdraw", get(show_withdraw_page).post(post_withdraw))
        .route("/look/{slot}/{file}", get(serve_panorama))
        .route("/film/{slot}/{file}", get(serve_film_picture))
        .route("/style.css", get(|| async { asset("text/css; charset=utf-8", include_str!("assets/style.css")) }))
        .route("/script.js", get(serve_script))
        .route("/favicon.ico", get(|| async { StatusCode::NO_CONTENT }))
        .fallback(|State(site): SiteState| async move { RequestProblem::Missing.problem_page(&site) })
        .method_not_allowed_fallback(|State(site): SiteState| async move { RequestProblem::Method.problem_page(&site) })
        .layer(DefaultBodyLimit::max(MAX_FORM_BYTES))
        .layer(middleware::from_fn_with_state(Arc::clone(&site), guard_request))
        .with_state(site)
}

/// Wraps every request: checks the origin of forms, limits the time, and adds the security headers.
async fn guard_request(State(site): SiteState, request: Request, next: Next) -> Response {
    let is_foreign = request_guard::changes_state(request.method())
        && !request_guard::comes_from_this_site(request.headers(), site.public.as_deref(), site.scheme);
    let mut response = if is_foreign {
        RequestProblem::Foreign.problem_page(&site)
    } else {
        match tokio::time::timeout(REQUEST_TIMEOUT, next.run(request)).await {
            Ok(response) => response,
            Err(_) => RequestProblem::Busy.problem_page(&site),
        }
    };
    for (name, value) in request_guard::response_headers(site.cookies.is_secure) {
        response.headers_mut().entry(name).or_insert(value);
    }
    response
}

/// Why a request gets an error page.
#[derive(Debug, Clone, Copy)]
enum RequestProblem {
    /// Nothing is at this address.
    Missing,
    /// The address does not take this HTTP method.
    Method,
    /// A form came from another site.
    Foreign,
    /// No participant belongs to the request.
    NoSession,
    /// The rate limit was exceeded.
    Fast,
    /// The store took too long, or its queue is full.
    Busy,
    /// The disk is full, or cannot be written.
    Disk,
    /// The browser does not send cookies back.
    NoCookies,
    /// The form is too long.
    Large,
    /// The form cannot be read.
    Form,
    /// The form belongs to another stage or another participant.
    OutOfTurn,
    /// The lease of the item ran out.
    Returned,
    /// The study is closed.
    Closed,
    /// A picture cannot be read.
    Fault,
}

impl RequestProblem {
    fn problem_page(self, site: &StudySite) -> Response {
        let (status, name, retry) = match self {
            Self::Missing => (StatusCode::NOT_FOUND, "missing", false),
            Self::Method => (StatusCode::METHOD_NOT_ALLOWED, "missing", false),
            Self::Foreign => (StatusCode::FORBIDDEN, "foreign", false),
            Self::NoSession => (StatusCode::FORBIDDEN, "unknown", false),
            Self::NoCookies => (StatusCode::FORBIDDEN, "cookies", false),
            Self::Fast => (StatusCode::TOO_MANY_REQUESTS, "fast", true),
            Self::Busy => (StatusCode::SERVICE_UNAVAILABLE, "busy", true),
            Self::Disk => (StatusCode::SERVICE_UNAVAILABLE, "full", true),
            Self::Large => (StatusCode::PAYLOAD_TOO_LARGE, "large", false),
            Self::Form => (StatusCode::BAD_REQUEST, "form", true),
            Self::OutOfTurn => (StatusCode::CONFLICT, "turn", true),
            Self::Returned => (StatusCode::CONFLICT, "returned", true),
            Self::Closed => (StatusCode::GONE, "closed", false),
            Self::Fault => (StatusCode::INTERNAL_SERVER_ERROR, "fault", true),
        };
        let mut response = page_response(site, status, &StudyPage::named_message(&site.study, name, retry));
        if matches!(self, Self::Fast | Self::Busy | Self::Disk) {
            response.headers_mut().insert(header::RETRY_AFTER, RETRY_AFTER_SECONDS);
        }
        response
    }
}

impl From<DeskError> for RequestProblem {
    fn from(error: DeskError) -> Self {
        match error {
            DeskError::Busy => Self::Busy,
            DeskError::Disk => Self::Disk,
        }
    }
}

impl From<InputRefusal> for RequestProblem {
    fn from(refusal: InputRefusal) -> Self {
        match refusal {
            InputRefusal::Unknown => Self::Missing,
            InputRefusal::OutOfTurn => Self::OutOfTurn,
            InputRefusal::Returned => Self::Returned,
            InputRefusal::Closed => Self::Closed,
        }
    }
}

/// A response with a page as HTML.
fn page_response(site: &StudySite, status: StatusCode, page: &StudyPage) -> Response {
    let html = header::HeaderValue::from_static("text/html; charset=utf-8");
    match site.pages.render_html(page) {
        Ok(text) => (status, [(header::CONTENT_TYPE, html)], text).into_response(),
        Err(_) => {
            let words = site.study.texts.text("message", "fault_title").to_owned();
            (StatusCode::INTERNAL_SERVER_ERROR, words).into_response()
        }
    }
}

/// Redirects to `/`, where the participant's page is.
fn redirect_home() -> Response {
    redirect_with_cookies(HeaderValue::from_static("/"), [])
}

/// Redirects and sets cookies.
fn redirect_with_cookies(to: HeaderValue, cookies: impl IntoIterator<Item = Option<HeaderValue>>) -> Response {
    let mut response = (StatusCode::SEE_OTHER, [(header::LOCATION, to)]).into_response();
    for cookie in cookies.into_iter().flatten() {
        response.headers_mut().append(header::SET_COOKIE, cookie);
    }
    response
}

fn asset(kind: &'static str, text: impl IntoResponse) -> Response {
    let mut response = text.into_response();
    response.headers_mut().insert(header::CONTENT_TYPE, HeaderValue::from_static(kind));
    response
}

async fn serve_script(State(site): SiteState) -> Response {
    asset("text/javascript; charset=utf-8", site.script.clone())
}

/// The script of the pages, with its words in front of it.
pub(super) fn script_with_words(texts: &PageTexts) -> String {
    let words: BTreeMap<&str, _> =
        ["script", "film", "walk"].into_iter().map(|name| (name, texts.sections().get(name))).collect();
    // JSON is also JavaScript. No page contains the script, so no word can end it.
    format!("'use strict';\nconst T = {};\n{}", serde_json::json!(words), include_str!("assets/script.js"))
}

fn response_or_problem_page(result: Result<Response, RequestProblem>, site: &StudySite) -> Response {
    result.unwrap_or_else(|problem| problem.problem_page(site))
}

/// Finds the participant who asks, and applies the rate limit of participants or of strangers.
async fn identify_requester(site: &StudySite, headers: &HeaderMap) -> Result<Option<(i64, String)>, RequestProblem> {
    let requester = session_person(site, headers).await?;
    let asker = requester.as_ref().map_or(RequestSource::Stranger, |(person, _)| RequestSource::Person(*person));
    if site.pace.allows_request(asker) { Ok(requester) } else { Err(RequestProblem::Fast) }
}

/// The participant of a session and the person's mark. For a cookie that was never valid, the strangers' rate limit is applied before
/// the database is asked.
async fn session_person(site: &StudySite, headers: &HeaderMap) -> Result<Option<(i64, String)>, RequestProblem> {
    let session = site.cookies.session_token(headers).filter(|session| is_token(session));
    Ok(match session {
        Some(session) => {
            if !site.pace.knows_session(&session) && !site.pace.allows_request(RequestSource::Stranger) {
                return Err(RequestProblem::Fast);
            }
            let asked = session.clone();
            let found = site.desk.ask_store(move |transaction| transaction.person_by_session(&asked)).await?;
            if found.is_some() {
                site.pace.remember_session(session);
            }
            found.map(|(person, name)| (person, person_mark(&name)))
        }
        None => None,
    })
}

/// The participant who asks, with the values for the pages. A request without a session is an error.
async fn require_person(site: &StudySite, headers: &HeaderMap) -> Result<(i64, PageContext), RequestProblem> {
    let (person, mark) = identify_requester(site, headers).await?.ok_or(RequestProblem::NoSession)?;
    Ok((person, PageContext { who: Some(mark), ..PageContext::default() }))
}

/// Answers `/`: the page of the participant's stage, the consent page for a new arrival, or a message.
async fn show_current_page(State(site): SiteState, address: Uri, headers: HeaderMap) -> Response {
    let page = async {
        if address.query() == Some("arrived") {
            // The cookie came back: the address becomes plain. Without it, the browser keeps none.
            let has_cookie =
                site.cookies.session_token(&headers).is_some() || site.cookies.pending_arrival(&headers).is_some();
            return if has_cookie { Ok(redirect_home()) } else { Err(RequestProblem::NoCookies) };
        }
        if let Some((person, mark)) = identify_requester(&site, &headers).await? {
            let page_context = PageContext { who: Some(mark), ..PageContext::default() };
            return stage_response(&site, person, page_context, StatusCode::OK).await;
        }
        let Some(arrival) = site.cookies.pending_arrival(&headers) else {
            return Ok(page_response(&site, StatusCode::OK, &refusal_page(&site.study, &ArrivalOutcome::Unknown)));
        };
        match site.desk.ask_store(move |transaction| transaction.enter_study(&arrival)).await? {
            ArrivalOutcome::New => {
                Ok(page_response(&site, StatusCode::OK, &StudyPage::consent_page(&site.study, &PageContext::default())))
            }
            entry => Ok(arrival_response(&site, entry)),
        }
    };
    response_or_problem_page(page.await, &site)
}

/// The page of the participant's stage. In a closed study only those who have finished get it.
async fn stage_response(
    site: &StudySite,
    person: i64,
    page_context: PageContext,
    status: StatusCode,
) -> Result<Response, RequestProblem> {
    let page = move |transaction: &StudyTransaction<'_>| {
        if transaction.is_closed()? && !transaction.is_over(person)? {
            return Ok(None);
        }
        StudyPage::page_for_stage(transaction, person, &page_context).map(Some)
    };
    match site.desk.ask_store(page).await? {
        Some(page) => Ok(page_response(site, status, &page)),
        None => Err(RequestProblem::Closed),
    }
}

/// Answers an arrival: opens a session for a participant, and shows a message otherwise.
fn arrival_response(site: &StudySite, entry: ArrivalOutcome) -> Response {
    match entry {
        ArrivalOutcome::Back(session) => {
            redirect_with_cookies(ARRIVED_PAGE, [site.cookies.set_session(&session), site.cookies.drop_arrival()])
        }
        entry => {
            let status = match entry {
                ArrivalOutcome::Full => StatusCode::CONFLICT,
                ArrivalOutcome::Closed => StatusCode::GONE,
                _ => StatusCode::FORBIDDEN,
            };
            page_response(site, status, &refusal_page(&site.study, &entry))
        }
    }
}

/// Answers a visitor who opens a link: leads to the consent page or back into the study, or shows a message.
async fn handle_arrival(
    site: &StudySite,
    headers: &HeaderMap,
    arrival: ParticipantArrival,
) -> Result<Response, RequestProblem> {
    if !site.pace.allows_request(RequestSource::Stranger) {
        return Err(RequestProblem::Fast);
    }
    let asked = arrival.clone();
    Ok(match site.desk.ask_store(move |transaction| transaction.enter_study(&asked)).await? {
        // This ends the session of another person on the same machine. If the study is full, the page at `/` tries again.
        ArrivalOutcome::New | ArrivalOutcome::Full => {
            redirect_with_cookies(ARRIVED_PAGE, [site.cookies.set_arrival(&arrival), site.cookies.drop_session()])
        }
        // A closed study knows no recruiter's link any more. In the browser in which somebody took part, the session still leads to the code.
        ArrivalOutcome::Closed if session_person(site, headers).await?.is_some() => redirect_home(),
        entry => arrival_response(site, entry),
    })
}

/// Begins a walk through the study as a new participant, in a preview.
async fn begin_preview(State(site): SiteState) -> Response {
    let begin = async {
        if !site.is_preview {
            return Err(RequestProblem::Missing);
        }
        let token = site.desk.ask_store(|transaction| Ok(transaction.invite_participants(1)?.tokens)).await?.pop();
        let arrival = ParticipantArrival::Link(token.ok_or(RequestProblem::Fault)?);
        handle_arrival(&site, &HeaderMap::new(), arrival).await
    };
    response_or_problem_page(begin.await, &site)
}

/// A personal link.
async fn open_personal_link(
    State(site): SiteState,
    token: Result<Path<String>, PathRejection>,
    headers: HeaderMap,
) -> Response {
    let Ok(Path(token)) = token else { return RequestProblem::Missing.problem_page(&site) };
    response_or_problem_page(handle_arrival(&site, &headers, ParticipantArrival::Link(token)).await, &site)
}

/// A recruiter's link. Its ids go into a cookie and out of the address at once, so that the browser's history does not show them.
async fn open_recruiter_link(
    State(site): SiteState,
    Query(query): Query<BTreeMap<String, String>>,
    headers: HeaderMap,
) -> Response {
    let RecruiterSettings::Parameters { person, session, study, .. } = &site.study.settings.recruiter else {
        return RequestProblem::Missing.problem_page(&site);
    };
    if query.get(session).is_some_and(|session| session == MTURK_PREVIEW_ID) {
        return page_response(
            &site,
            StatusCode::OK,
            &StudyPage::named_message(&site.study, "recruiter_preview", false),
        );
    }
    let value = |name: &String| query.get(name).cloned().unwrap_or_default();
    if let Some(parameter) = [person, session].into_iter().find(|name| !may_be_issued(&value(name), name)) {
        let texts = &site.study.texts;
        let text = fill_placeholders(texts.text("message", "no_id_text"), [("parameter", parameter.clone())]);
        let page = StudyPage::message_page(&site.study, texts.text("message", "no_id_title"), &text, false);
        return page_response(&site, StatusCode::FORBIDDEN, &page);
    }
    let arrival = ParticipantArrival::Recruit { person: value(person), session: value(session), study: value(study) };
    response_or_problem_page(handle_arrival(&site, &headers, arrival).await, &site)
}

/// The fields of a form.
async fn read_form(request: Request) -> Result<(HeaderMap, FormFields), RequestProblem> {
    let headers = request.headers().clone();
    match Form::<Vec<(String, String)>>::from_request(request, &()).await {
        Ok(Form(pairs)) => Ok((headers, pairs.into_iter().collect())),
        Err(rejection) if rejection.status() == StatusCode::PAYLOAD_TOO_LARGE => Err(RequestProblem::Large),
        Err(_) => Err(RequestProblem::Form),
    }
}

/// Whether the form belongs to the session that sends it. On a shared machine, an old tab may belong to another participant.
fn belongs_to_session(fields: &FormFields, page_context: &PageContext) -> bool {
    fields.get("who").is_none_or(|who| page_context.who.as_ref() == Some(who))
}

async fn post_consent(State(site): SiteState, request: Request) -> Response {
    let done = async {
        let (headers, fields) = read_form(request).await?;
        if identify_requester(&site, &headers).await?.is_some() {
            return Ok(redirect_home());
        }
        let arrival = site.cookies.pending_arrival(&headers).ok_or(RequestProblem::NoSession)?;
        if fields.get("agree").map(String::as_str) != Some("yes") {
            let mut response = page_response(&site, StatusCode::OK, &StudyPage::gone_page(&site.study, false));
            // The next visitor at this machine is another person.
            if let Some(cookie) = site.cookies.drop_arrival() {
                response.headers_mut().append(header::SET_COOKIE, cookie);
            }
            return Ok(response);
        }
        let version = consent_version(&site.study);
        if fields.get("version").is_some_and(|read| *read != version) {
            let error = Some("consent_changed");
            let page = StudyPage::consent_page(&site.study, &PageContext { error, ..PageContext::default() });
            return Ok(page_response(&site, StatusCode::UNPROCESSABLE_ENTITY, &page));
        }
        Ok(arrival_response(
            &site,
            site.desk.ask_store(move |transaction| transaction.record_consent(&arrival, &version)).await?,
        ))
    };
    response_or_problem_page(done.await, &site)
}

/// Stores the input of a form. If a field is missing, the page is shown again with a message.
async fn post_input(
    site: &StudySite,
    request: Request,
    read: impl FnOnce(&FormFields) -> Result<ParticipantInput, &'static str>,
) -> Result<Response, RequestProblem> {
    let (headers, fields) = read_form(request).await?;
    let (person, page_context) = require_person(site, &headers).await?;
    if !belongs_to_session(&fields, &page_context) {
        return Err(RequestProblem::OutOfTurn);
    }
    match read(&fields) {
        Ok(input) => {
            site.desk.ask_store(move |transaction| transaction.store_input(person, input)).await??;
            Ok(redirect_home())
        }
        Err(error) => {
            let page_context = PageContext { error: Some(error), given: Some(fields), ..page_context };
            stage_response(site, person, page_context, StatusCode::UNPROCESSABLE_ENTITY).await
        }
    }
}

async fn post_comprehension(State(site): SiteState, request: Request) -> Response {
    let questions = site.study.settings.questions.len();
    response_or_problem_page(
        post_input(&site, request, |fields| forms::read_comprehension(fields, questions)).await,
        &site,
    )
}

async fn post_own_text(State(site): SiteState, request: Request) -> Response {
    response_or_problem_page(post_input(&site, request, forms::read_own_text).await, &site)
}

async fn post_end(State(site): SiteState, request: Request) -> Response {
    let questions = &site.study.settings.end;
    response_or_problem_page(post_input(&site, request, |fields| forms::read_end(fields, questions)).await, &site)
}

async fn post_move(State(site): SiteState, request: Request) -> Response {
    response_or_problem_page(post_input(&site, request, forms::read_move).await, &site)
}

async fn post_stop(State(site): SiteState, request: Request) -> Response {
    response_or_problem_page(post_input(&site, request, forms::read_stop).await, &site)
}

async fn post_again(State(site): SiteState, request: Request) -> Response {
    response_or_problem_page(post_input(&site, request, forms::read_again).await, &site)
}

async fn post_answer(State(site): SiteState, request: Request) -> Response {
    let mode: StudyTask = site.study.plan.mode;
    response_or_problem_page(post_input(&site, request, |fields| forms::read_answer(fields, mode)).await, &site)
}

async fn post_attention(State(site): SiteState, request: Request) -> Response {
    response_or_problem_page(post_input(&site, request, forms::read_attention).await, &site)
}

async fn show_withdraw_page(State(site): SiteState, headers: HeaderMap) -> Response {
    let page = async {
        let (_, page_context) = require_person(&site, &headers).await?;
        Ok(page_response(&site, StatusCode::OK, &StudyPage::withdraw_page(&site.study, &page_context)))
    };
    response_or_problem_page(page.await, &site)
}

async fn post_withdraw(State(site): SiteState, request: Request) -> Response {
    let done = async {
        let (headers, fields) = read_form(request).await?;
        let is_delete = fields.get("delete").map(String::as_str) == Some("yes");
        let (person, page_context) = match require_person(&site, &headers).await {
            // The same request again: the first one was carried out, but its reply was lost.
            Err(RequestProblem::NoSession) if is_delete => {
                return Ok(page_response(&site, StatusCode::OK, &StudyPage::gone_page(&site.study, true)));
            }
            found => found?,
        };
        if !belongs_to_session(&fields, &page_context) {
            return Err(RequestProblem::OutOfTurn);
        }
        match fields.get("delete").map(String::as_str) {
            Some("yes") => {
                site.desk
                    .ask_store(move |transaction| transaction.withdraw_person(person, WithdrawalChoice::Delete))
                    .await?;
                site.desk.request_sweep();
                let mut response = page_response(&site, StatusCode::OK, &StudyPage::gone_page(&site.study, true));
                if let Some(cookie) = site.cookies.drop_session() {
                    response.headers_mut().append(header::SET_COOKIE, cookie);
                }
                Ok(response)
            }
            Some("no") => {
                site.desk
                    .ask_store(move |transaction| transaction.withdraw_person(person, WithdrawalChoice::Keep))
                    .await?;
                Ok(redirect_home())
            }
            _ => {
                let page_context = PageContext { error: Some("choose_end"), ..page_context };
                Ok(page_response(
                    &site,
                    StatusCode::UNPROCESSABLE_ENTITY,
                    &StudyPage::withdraw_page(&site.study, &page_context),
                ))
            }
        }
    };
    response_or_problem_page(done.await, &site)
}

async fn serve_panorama(State(site): SiteState, path: SlotFile, headers: HeaderMap) -> Response {
    let Ok(Path((slot, file))) = path else { return RequestProblem::Missing.problem_page(&site) };
    let find =
        move |transaction: &StudyTransaction<'_>, person, number| transaction.panorama_file(person, &slot, number);
    response_or_problem_page(picture_response(&site, &headers, &file, find).await, &site)
}

async fn serve_film_picture(State(site): SiteState, path: SlotFile, headers: HeaderMap) -> Response {
    let Ok(Path((slot, file))) = path else { return RequestProblem::Missing.problem_page(&site) };
    let find =
        move |transaction: &StudyTransaction<'_>, person, number| transaction.film_picture(person, &slot, number);
    response_or_problem_page(picture_response(&site, &headers, &file, find).await, &site)
}

/// Sends a picture of an item that this participant has. `find` looks up the name of its file. It comes from the
/// study, and never from the address.
async fn picture_response(
    site: &StudySite,
    headers: &HeaderMap,
    file: &str,
    find: impl FnOnce(&StudyTransaction<'_>, i64, usize) -> Result<Option<String>, StudyError> + Send + 'static,
) -> Result<Response, RequestProblem> {
    let number = file.strip_suffix(".jpg").and_then(|number| number.parse().ok()).ok_or(RequestProblem::Missing)?;
    let (person, _) = session_person(site, headers).await?.ok_or(RequestProblem::NoSession)?;
    if !site.pace.allows_request(RequestSource::Pictures(person)) {
        return Err(RequestProblem::Fast);
    }
    let name = site
        .desk
        .ask_store(move |transaction| find(transaction, person, number))
        .await?
        .ok_or(RequestProblem::Missing)?;
    let _permit = site.readers.acquire().await.map_err(|_| RequestProblem::Busy)?;
    let path = site.study.pictures_folder().join(name);
    let bytes = tokio::task::spawn_blocking(move || std::fs::read(path)).await;
    let bytes = bytes.ok().and_then(Result::ok).ok_or(RequestProblem::Fault)?;
    let headers = [
        (header::CONTENT_TYPE, HeaderValue::from_static("image/jpeg")),
        // A phone should not have to load a film twice. Caching is safe, because the address contains only a slot of this person.
        (header::CACHE_CONTROL, HeaderValue::from_static("private, max-age=3600")),
    ];
    Ok((headers, Body::from(bytes)).into_response())
}
