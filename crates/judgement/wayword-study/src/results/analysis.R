# --- Reading the files -------------------------------------------------------------------------------------------------------------------

# Text that begins like a formula, or with an apostrophe, has one apostrophe in front.
read_sheet <- function(file) {
  sheet <- read.csv(file.path(folder, file), encoding = "UTF-8", check.names = FALSE, stringsAsFactors = FALSE)
  for (name in names(sheet)) if (is.character(sheet[[name]])) sheet[[name]] <- sub("^'", "", sheet[[name]])
  sheet
}

# --- Intervals, by the rules of `wayword study results` ----------------------------------------------------------------------------------

# The variance of a sum of errors, clustered by persons and by items: V(persons) + V(items) - V(cells), never below the larger of the
# first two (Cameron, Gelbach and Miller 2011). `estimated` figures were estimated from these answers.
clustered_variance <- function(person, item, error, estimated) {
  n <- length(error)
  correction <- (n - 1) / max(n - estimated, 1)
  part <- function(group) {
    sums <- tapply(error, group, sum)
    groups <- length(sums)
    if (groups > 1) correction * sum(sums^2) * groups / (groups - 1) else 0
  }
  persons <- part(person)
  items <- part(item)
  cells <- part(paste(person, item))
  larger <- max(persons, items)
  if (larger <= 1e-20 * cells) cells else max(larger, persons + items - cells)
}

wilson <- function(ones, n) {
  z <- qnorm(0.5 + level / 2)
  share <- ones / n
  middle <- (share + z^2 / (2 * n)) / (1 + z^2 / n)
  half <- z * sqrt(share * (1 - share) / n + z^2 / (4 * n^2)) / (1 + z^2 / n)
  c(max(middle - half, 0), min(middle + half, 1))
}

# One figure: its value, standard error and interval. `given` has the columns person, item and value.
figure <- function(given, is_share) {
  n <- nrow(given)
  persons <- length(unique(given$person))
  items <- length(unique(given$item))
  value <- mean(given$value)
  found <- list(value = value, se = NA, low = NA, high = NA, method = "none", answers = n, persons = persons, items = items)
  if (persons < 2 || items < 2) return(found)
  se <- sqrt(clustered_variance(given$person, given$item, (given$value - value) / n, 1))
  fewest <- min(persons, items)
  t <- qt(0.5 + level / 2, fewest - 1)
  if (se > 0) found$se <- se
  independent <- persons == n && items == n
  ends <- c(NA, NA)
  if (is_share && independent) {
    found$method <- "Wilson"
    ends <- wilson(sum(given$value), n)
  } else if (is_share && (value == 0 || value == 1)) {
    found$method <- "extreme"
    ends <- wilson(value * fewest, fewest)
  } else if (se > 0) {
    found$method <- if (independent && !is_share) "Student" else "clustered"
    if (is_share) {
      half <- t * se / (value * (1 - value))
      ends <- plogis(qlogis(value) + c(-half, half))
    } else {
      ends <- value + c(-1, 1) * t * se
    }
  }
  found$low <- ends[1]
  found$high <- ends[2]
  found
}

# The first minus the second condition. Conditions can share persons and items, whose effects then cancel.
difference <- function(first, second, is_share) {
  one <- figure(first, is_share)
  other <- figure(second, is_share)
  both <- rbind(first, second)
  error <- c((first$value - one$value) / nrow(first), -(second$value - other$value) / nrow(second))
  squares <- c(one$se, other$se)^2
  squares[is.na(squares)] <- 0
  shared <- function(name) {
    all <- length(unique(both[[name]]))
    counts <- c(length(unique(first[[name]])), length(unique(second[[name]])))
    list(is = all < sum(counts), count = if (all < sum(counts)) all else min(counts))
  }
  persons <- shared("person")
  items <- shared("item")
  apart <- !persons$is && !items$is
  variance <- if (apart) sum(squares) else clustered_variance(both$person, both$item, error, 2)
  product <- 2 * sqrt(prod(squares))
  correlation <- if (product > 0) max(-1, min(1, (sum(squares) - variance) / product)) else 0
  value <- one$value - other$value
  ends <- c(NA, NA)
  if (is_share && !anyNA(c(one$low, other$low))) {
    # MOVER (Zou and Donner 2008); for independent answers Newcombe's interval.
    together <- function(x, y) sqrt(max(0, x^2 + y^2 - 2 * correlation * x * y))
    ends <- c(
      max(-1, value - together(one$value - one$low, other$high - other$value)),
      min(1, value + together(one$high - one$value, other$value - other$low))
    )
  } else if (!is_share && min(one$persons, one$items, other$persons, other$items) > 1 && variance > 0) {
    half <- sqrt(variance) * qt(0.5 + level / 2, min(persons$count, items$count) - 1)
    ends <- value + c(-half, half)
  }
  list(value = value, low = ends[1], high = ends[2])
}

clip <- function(ends, range) c(max(ends[1], range[1]), min(ends[2], range[2]))

# --- Figures -----------------------------------------------------------------------------------------------------------------------------

answers <- read_sheet("answers.csv")
answers_of <- function(version, condition, measure) {
  own <- answers[answers[[paste0("in_", version)]] == 1 & answers$condition == condition, ]
  given <- data.frame(person = own$participant, item = own$route, value = as.numeric(measure$value(own)))
  given[!is.na(given$value), ]
}

if (mode == "pair") {
  # Each comparison judges two texts: the gain of a text is 1 if it was preferred, a half without a preference, else 0.
  side <- function(own) {
    judged <- answers
    judged$condition <- answers[[own]]
    judged$gain <- ifelse(answers$preferred == "", 0.5, as.numeric(answers$preferred == answers[[own]]))
    judged
  }
  answers <- rbind(side("condition_a"), side("condition_b"))
}

rows <- list()
for (version in versions) {
  for (name in names(measures)) {
    measure <- measures[[name]]
    first <- answers_of(version, conditions[1], measure)
    for (condition in conditions) {
      given <- answers_of(version, condition, measure)
      if (nrow(given) == 0) next
      found <- figure(given, measure$share)
      ends <- clip(c(found$low, found$high), measure$range)
      rows[[length(rows) + 1]] <- data.frame(
        version = version, figure = name, condition = condition, minus = "", value = found$value, low = ends[1], high = ends[2],
        method = found$method, answers = found$answers, persons = found$persons, routes = found$items
      )
      if (mode == "pair" || condition == conditions[1] || nrow(first) == 0) next
      apart <- difference(given, first, measure$share)
      widest <- if (is.finite(measure$range[2])) measure$range[2] - measure$range[1] else Inf
      ends <- clip(c(apart$low, apart$high), c(-widest, widest))
      rows[[length(rows) + 1]] <- data.frame(
        version = version, figure = name, condition = condition, minus = conditions[1], value = apart$value, low = ends[1],
        high = ends[2], method = "", answers = nrow(given) + nrow(first), persons = NA, routes = NA
      )
    }
  }
}
if (length(rows) == 0) stop("there are no answers yet", call. = FALSE)
figures <- do.call(rbind, rows)
print(figures, digits = 3)
write.csv(figures, file.path(folder, "figures_by_R.csv"), row.names = FALSE)

# --- A mixed model beside it, if lme4 is installed ---------------------------------------------------------------------------------------

if (requireNamespace("lme4", quietly = TRUE) && length(conditions) > 1 && mode != "pair") {
  for (name in names(measures)[vapply(measures, function(measure) measure$share, logical(1))]) {
    given <- do.call(rbind, lapply(conditions, function(condition) {
      own <- answers_of("finished", condition, measures[[name]])
      if (nrow(own) > 0) cbind(own, condition = condition)
    }))
    if (is.null(given) || length(unique(given$value)) < 2) next
    given$condition <- factor(given$condition, levels = conditions)
    cat("\n", name, ": logit, random intercepts of persons and routes\n", sep = "")
    fit <- try(lme4::glmer(value ~ condition + (1 | person) + (1 | item), data = given, family = binomial), silent = TRUE)
    if (inherits(fit, "try-error")) cat("not fitted:", conditionMessage(attr(fit, "condition")), "\n") else print(summary(fit)$coefficients)
  }
}
