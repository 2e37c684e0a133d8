; Everything that is read.
(define (domain table)
  (:requirements :strips :typing :negative-preconditions :disjunctive-preconditions :equality
                 :existential-preconditions :universal-preconditions :quantified-preconditions
                 :conditional-effects :derived-predicates :ADL)
  (:types item - thing  can box - item  place - thing
          grasp path pose)
  (:constants bin - place me)
  (:predicates
    (On ?i - item ?p - place)
    (InHand ?i - item ?g - grasp)
    (HandEmpty)
    (AtPose ?i - item ?q - pose)
    (Moved ?i)
    (Item ?i - item) ; the rest is for streams to say
    (Grasp ?i - item ?g - grasp)
    (Pose ?i - item ?q - pose ?p - place)
    (Motion ?from ?to - pose ?t - path)
    (Clear ?t - path ?i - item)
    (Free ?p - place)
    (Safe ?t - path))

  (:derived (Free ?p)
    (not (exists (?i - item) (On ?i ?p))))
  (:derived (Safe ?t - path)
    (forall (?i - item ?p - place)
      (imply (and (On ?i ?p) (not (Free ?p))) (Clear ?t ?i))))

  (:action pick
    :parameters (?o - item ?g - grasp ?p - place ?who)
    :precondition (AND
      (Grasp ?o ?g) (On ?o ?p) (HandEmpty)
      (= ?who me) (not (= ?p bin))
      (or (not (Moved ?o)) (Free bin))
      (and))
    :effect (and
      (InHand ?o ?g)
      (not (HandEmpty))
      (not (On ?o ?p))
      (forall (?q - pose)
        (when (AtPose ?o ?q)
          (and (not (AtPose ?o ?q))
               (forall (?o - item) (when (Moved ?o) (Moved ?q))))))
      (Moved ?o)))
  (:action wait))
